"""The rows on machines of the drawn league: oscillator, carriage, half-car, eSEA.

The rigs integrate the truth by their own code, with dry friction that truly sticks. What is hidden is a law
of theirs, whose values follow here from the amounts that were drawn.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from benchmarks.drawn import car, told
from benchmarks.drawn import draw as drawn
from benchmarks.drawn.amount import of_drive
from benchmarks.drawn.draw import Wanted
from benchmarks.drawn.laws import HARDENING_HYSTERESIS, VARYING_INERTIA
from benchmarks.drawn.machines import bench_of, case_of
from benchmarks.drawn.recipes import rms
from benchmarks.league.bench import Drive, Sensor
from benchmarks.league.laws import BACKLASH
from benchmarks.league.machines import RUNS, Case
from benchmarks.rebuilt.draw import Draw
from hybridid.records.record import Record
from hybridid.rigs.law_library import ASYMMETRIC_VISCOUS
from hybridid.rigs.laws import Planted
from hybridid.rigs.load_laws import LOAD_FRICTION
from hybridid.rigs.truth import PlantedAt

Array = NDArray[np.float64]
Amounts = Mapping[str, float]
GAMMA = 0.8
"""Of the hysteresis, as in Noël, Schoukens (2016), Hysteretic benchmark with a dynamic nonlinearity."""
BEHIND = 1 / 3
"""Share of the carriage's mass that lies behind the backlash."""


def as_drawn(draw: Draw) -> drawn.Draw:
    """The same machine of the drawn league, with nothing hidden; its excitation has the seed of ``draw``."""
    kind = "short" if draw.machine == "half_car" else draw.kind
    number = draw.seed - 1000  # the drawn league's seeds begin there
    return drawn.Draw(number, draw.machine, "nothing", draw.parameters, kind, draw.noise, None)


def case(draw: Draw) -> Case:
    """What is declared of the machine."""
    return case_of(as_drawn(draw))


def record(draw: Draw, run: str, noise: float, amounts: Amounts) -> Record:
    """The run of the machine of ``draw`` with ``amounts`` of what is hidden (none: nothing)."""
    machine = as_drawn(draw)
    if draw.machine == "half_car":
        return car.perform(machine, run, noise, _dampers(draw.parameters, amounts)).record
    if amounts and draw.row == "backlash":
        lighter = {**draw.parameters, "M": (1 - BEHIND) * draw.parameters["M"]}
        machine = replace(machine, parameters=lighter)
    bench = bench_of(machine)
    if amounts and draw.category == "saturation":
        path = Wanted("input_saturation", (bench.input.name,), amounts["share"], ())
        bench = replace(bench, drive=Drive(**of_drive(path, _plain(draw)).hidden[0].values))
    elif amounts:
        bench = replace(bench, planted={next(iter(bench.contacts)): (_law(draw, amounts),)})
    sensors = dict.fromkeys(bench.outputs, Sensor(noise))
    return told.perform(bench, run, sensors, draw.seed).record


def _dampers(p: Mapping[str, float], amounts: Amounts) -> list[PlantedAt]:
    """Both dampers, each ``amount`` stiffer in rebound (v < 0) than in compression, their means kept."""
    axles = {"front": p["c_f"], "rear": p["c_r"]}
    return [
        PlantedAt(f"{axle}_suspension", ASYMMETRIC_VISCOUS(difference=2 * c * a / (2 + a)))
        for axle, c in axles.items()
        if (a := amounts.get(axle))
    ]


def _plain(draw: Draw) -> told.Seen:
    """The run to fit, without noise and with nothing hidden."""
    bench = bench_of(as_drawn(draw))
    return told.perform(bench, RUNS[0], dict.fromkeys(bench.outputs, Sensor(0.0)), 0)


def _load(draw: Draw, seen: told.Seen) -> Array | float:
    """What the load exerts on the first contact: the eSEA's rubber on its motor, nothing on a carriage."""
    return -draw.parameters["K_e"] * seen.motion["elastomer"][0] if draw.machine == "esea" else 0.0


def _law(draw: Draw, amounts: Amounts) -> Planted:
    p = draw.parameters
    if draw.row == "backlash":
        return BACKLASH(
            mass=BEHIND * p["M"],
            frequency=amounts["frequency"],
            damping=amounts["damping"],
            gap=amounts["gap"] / 2,
        )
    seen = _plain(draw)
    if draw.category == "load_friction":
        return LOAD_FRICTION(mu=amounts["share"] * rms(seen.drive) / rms(seen.drive - _load(draw, seen)))
    ((q, _),) = seen.motion.values()
    if draw.row == "hysteresis":
        return HARDENING_HYSTERESIS(
            f_c=amounts["share"] * rms(seen.drive),
            s=amounts["s"] * float(q.std()),
            gamma=GAMMA,
            delta=-GAMMA * amounts["stiffening"],
        )
    reach = float(q.max() - q.min())
    others = {name: p[name] for name in ("M", "f_v", "f_c", "offset")}
    return VARYING_INERTIA(
        dm=amounts["share"] * p["M"],
        load=0.0,
        q_0=float(q.min()) + amounts["place"] * reach,
        width=amounts["width"] * reach,
        k=0.0,
        **others,
    )
