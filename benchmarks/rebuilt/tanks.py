"""Two tanks, one above the other: the plant as a user would write it, and its simulation.

    x_1' = k_p u - k_1 sqrt(x_1) - o        o = WEIR (x_1 - limit)^1.5 above the limit (hidden)
    x_2' = k_1 sqrt(x_1) - k_2 sqrt(x_2) + share o

Levels in volts of their sensors, of which the lower is recorded; u is the pump's voltage, held over 4 s.

Source: Schoukens, Mattsson, Wigren, Noël (2016), Cascaded tanks benchmark combining soft and hard
nonlinearities; overflow over an edge: Francis' weir, White (2011), Fluid Mechanics, 7th ed., sec. 10.7.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import final

import casadi as ca
import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from benchmarks.drawn.excitation import sines
from benchmarks.league.machines import RUNS
from benchmarks.rebuilt.draw import Draw
from hybridid.declarations import Parameter, Port, Signal, State
from hybridid.plants.plant import Motion, Plant
from hybridid.records.record import Channel, Record

Array = NDArray[np.float64]
DT, SAMPLES = 4.0, 1024
WEIR = 2.0
"""Of the overflow [V/s over V^1.5]: some tenths of a volt over the edge carry all that the pump gives."""
LOWEST = 1e-6
"""Level [V] below which an outlet gives no more: keeps the slope of the root finite."""


def _tank(name: str, meaning: str) -> Port:
    return Port(
        name,
        "flow",
        effort_unit="V/s",
        effort_scale=0.1,
        position_unit="V",
        position_scale=5.0,
        velocity_scale=0.05,
        meaning=meaning,
    )


@final
class Tanks(Plant):
    """Two equal tanks; what the upper loses through its outlet the lower gains."""

    name = "tanks"
    meaning = "two tanks, one above the other, fed by a pump"
    source = "Schoukens, Mattsson, Wigren, Noël (2016), Cascaded tanks benchmark"
    states = (
        State("x_2", "V", scale=5.0, observed_by="level", derivative=0, meaning="lower level"),
        State("x_1", "V", scale=5.0, meaning="upper level"),
    )
    inputs = (Signal("pump", "V", "voltage of the pump"),)
    outputs = (Signal("level", "V", "lower level"),)
    parameters = (
        Parameter("k_1", "sqrt(V)/s", guess=0.04, lower=1e-3, upper=1.0, meaning="outlet of the upper tank"),
        Parameter("k_2", "sqrt(V)/s", guess=0.04, lower=1e-3, upper=1.0, meaning="outlet of the lower tank"),
        Parameter("k_p", "1/s", guess=0.04, lower=1e-3, upper=1.0, meaning="flow of the pump over its volts"),
    )
    ports = (
        _tank("upper", "what else leaves the upper tank"),
        _tank("lower", "what else leaves the lower tank"),
        Port("pump", "input", effort_unit="V", effort_scale=3.0, meaning="pump"),
        Port("level", "output", effort_unit="V", effort_scale=5.0, meaning="sensor of the lower level"),
    )

    def motion(self, x, u, p):
        return {
            "upper": Motion(position=x.x_1, velocity=p.k_p * u.pump - p.k_1 * _root(x.x_1)),
            "lower": Motion(position=x.x_2, velocity=p.k_1 * _root(x.x_1) - p.k_2 * _root(x.x_2)),
        }

    def derivative(self, x, u, p, effort):
        at = self.motion(x, u, p)
        return {"x_1": at["upper"].velocity - effort["upper"], "x_2": at["lower"].velocity - effort["lower"]}

    def output(self, x, u, p):
        return {"level": x.x_2}


def _root(level):
    return ca.sqrt(ca.fmax(level, LOWEST))


def record(draw: Draw, run: str, noise: float, amounts: Mapping[str, float]) -> Record:
    """The run of the tanks of ``draw`` with ``amounts`` of what is hidden (none: nothing)."""
    p = draw.parameters
    pumps = {name: _pump(draw, name) for name in RUNS}
    limit, share = np.inf, 0.0
    if amounts:
        limit = amounts["level"] * max(_levels(p, u)[:, 0].max() for u in pumps.values())
        share = amounts["share"]
    levels = _levels(p, pumps[run], limit, share)
    generator = np.random.default_rng([draw.seed, RUNS.index(run)])
    return Record(
        name=run,
        time=DT * np.arange(SAMPLES),
        inputs=pumps[run][:, None],
        outputs=levels[:, 1:] + noise * generator.standard_normal((SAMPLES, 1)),
        input_channels=(Channel("pump", "V", "zoh"),),
        output_channels=(Channel("level", "V"),),
        simulated=True,
        source=f"rebuilt rows, two tanks, {run} run, seed {draw.seed} (simulated)",
    )


def _pump(draw: Draw, run: str) -> Array:
    """Voltage (n,) that asks for upper levels of 1 to 9 V, whatever the pump and the outlet are."""
    generator = np.random.default_rng([draw.seed, 10 + RUNS.index(run)])
    wanted = 2.0 + sines(generator, 12, (5e-4, 8e-3), 0.45)(DT * np.arange(SAMPLES))
    return np.clip(wanted, 1.0, 3.0) * draw.parameters["k_1"] / draw.parameters["k_p"]


def _levels(p: Mapping[str, float], pump: Array, limit: float = np.inf, share: float = 0.0) -> Array:
    """Levels (n, 2) of the upper and the lower tank, from rest at the first voltage."""

    def rates(t: float, x: Array, u: float) -> list[float]:
        flow = p["k_1"] * np.sqrt(max(x[0], 0.0))
        over = WEIR * max(x[0] - limit, 0.0) ** 1.5
        return [p["k_p"] * u - flow - over, flow - p["k_2"] * np.sqrt(max(x[1], 0.0)) + share * over]

    first = (p["k_p"] * pump[0] / p["k_1"]) ** 2
    levels = np.empty((len(pump), 2))
    levels[0] = min(first, limit), (p["k_1"] / p["k_2"]) ** 2 * min(first, limit)
    for k, u in enumerate(pump[:-1]):
        found = solve_ivp(rates, (0.0, DT), levels[k], "LSODA", args=(u,), rtol=1e-9, atol=1e-10)
        levels[k + 1] = found.y[:, -1]
    return levels
