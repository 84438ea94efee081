"""Dampers on a test rig that prescribes their motion: the plants as a user would write them, and the
simulation.

    force' = (k q + F - force) / TAU        TAU: of the load cell, from its data sheet

The rig drives the piston along a path that is known, so position and velocity are inputs. F holds the
damper's own viscous and dry friction, and what is hidden: friction behind a gap, friction whose level a
current sets, or pre-sliding so short that a sample at top speed travels a hundred of its lengths.

The velocity is a straight line between samples. Every law is followed along the travelled path in closed
form, over ``PIECES`` pieces a sample; no differential equation is stiff there.

Source: Spencer, Dyke, Sain, Carlson (1997), ASCE J. Engineering Mechanics 123(3) (test rig, field);
Badrakhan (1985), J. Sound and Vibration 100(2) (gap and slider in series); Dahl (1976), Wen (1976).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from itertools import accumulate

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import cumulative_trapezoid
from scipy.signal import lfilter

from benchmarks.drawn.excitation import sines
from benchmarks.drawn.recipes import rms
from benchmarks.league.machines import RUNS
from benchmarks.rebuilt.draw import Draw
from hybridid.declarations import Parameter, Port, Signal, State
from hybridid.plants.plant import Load, Motion, Plant
from hybridid.records.record import Channel, Record

Array = NDArray[np.float64]
DT, SAMPLES, PIECES = 5e-3, 2001, 40
TAU = 8e-3
SLOW, TURN = 0.004, 1.25
"""Of slow and fast strokes by turns: speed of the slow over that of the fast, length of a turn [s]."""
SIGMA = 0.7
"""Of the hidden Bouc-Wen hysteresis, n = 2."""
_PORT = {
    "kind": "effort",
    "effort_unit": "N",
    "effort_scale": 200.0,
    "position_unit": "m",
    "position_scale": 0.02,
    "velocity_scale": 0.1,
    "epsilon": 1e-4,
    "meaning": "piston in its cylinder",
}


class FrictionDamper(Plant):
    """A damper on a test rig: its gas spring k, and the load cell's lag. Friction consists of effects."""

    name = "friction_damper"
    meaning = "damper on a test rig that prescribes its motion"
    source = "a test rig as in Spencer, Dyke, Sain, Carlson (1997)"
    states = (State("f", "N", scale=200.0, observed_by="force", derivative=0, meaning="load cell"),)
    inputs = (Signal("displacement", "m", "of the piston"), Signal("velocity", "m/s", "of the piston"))
    outputs = (Signal("force", "N", "load cell"),)
    parameters = (Parameter("k", "N/m", guess=1000.0, lower=0.0, upper=1e5, meaning="gas spring"),)
    ports: tuple[Port, ...] = (
        Port("damper", **_PORT, no_load="the rig measures the whole force, not what presses the seal"),  # type: ignore[arg-type]
    )

    def motion(self, x, u, p):
        return {"damper": Motion(position=u.displacement, velocity=u.velocity)}

    def derivative(self, x, u, p, effort):
        return {"f": (p.k * u.displacement + effort["damper"] - x.f) / TAU}

    def output(self, x, u, p):
        return {"force": x.f}


class FieldDamper(FrictionDamper):
    """With a coil: a current sets the level of its friction."""

    name = "field_damper"
    meaning = "magneto-rheological damper on a test rig"
    inputs = (*FrictionDamper.inputs, Signal("current", "A", "of the coil"))
    ports = (Port("damper", **_PORT, level="current of the coil over 1 A"),)  # type: ignore[arg-type]

    def loads(self, x, u, p):
        return {"damper": Load(level=u.current)}


def record(draw: Draw, run: str, noise: float, amounts: Mapping[str, float]) -> Record:
    """The run of the damper of ``draw`` with ``amounts`` of what is hidden (none: nothing)."""
    way = _Way.of(draw, run)
    hidden = _Hidden.of(draw.row, amounts, _Way.of(draw, RUNS[0])) if amounts else None
    force = _through_cell(way.own + (hidden.effort(draw.row, way) if hidden else 0.0))[::PIECES]
    inputs = {"displacement": (way.q[::PIECES], "m", "foh"), "velocity": (way.v[::PIECES], "m/s", "foh")}
    if draw.machine == "field_damper":
        inputs["current"] = (way.level[::PIECES], "A", "zoh")
    noisy = np.random.default_rng([draw.seed, RUNS.index(run)]).standard_normal(SAMPLES)
    return Record(
        name=run,
        time=DT * np.arange(SAMPLES),
        inputs=np.column_stack([signal for signal, _, _ in inputs.values()]),
        outputs=(force + noise * noisy)[:, None],
        input_channels=tuple(Channel(name, unit, hold) for name, (_, unit, hold) in inputs.items()),
        output_channels=(Channel("force", "N"),),
        simulated=True,
        source=f"rebuilt rows, {draw.machine}, {run} run, seed {draw.seed} (simulated)",
    )


@dataclass(frozen=True)
class _Way:
    """Position, velocity, current and the damper's own force over the pieces of a run, (m,)."""

    q: Array
    v: Array
    level: Array
    own: Array

    @classmethod
    def of(cls, draw: Draw, run: str) -> _Way:
        generator = np.random.default_rng([draw.seed, 10 + RUNS.index(run)])
        time = DT * np.arange(SAMPLES)
        velocity = _velocity(draw, generator, time)
        current = np.clip(0.5 + sines(generator, 3, (0.1, 0.6), 0.3)(time), 0.0, 1.0)
        fine = np.linspace(0.0, time[-1], (SAMPLES - 1) * PIECES + 1)
        v = np.interp(fine, time, velocity)
        q = cumulative_trapezoid(v, fine, initial=0.0)
        level = np.append(np.repeat(current[:-1], PIECES), current[-1])
        p = draw.parameters
        return cls(q, v, level, p["f_v"] * v + p.get("f_c", 0.0) * np.sign(v) + p["k"] * q)


def _velocity(draw: Draw, generator: np.random.Generator, time: Array) -> Array:
    """Some 0.1 m/s RMS; of the stiff damper fast and slow strokes by turns."""
    if draw.machine != "stiff_damper":
        return sines(generator, 3, (0.3, 3.0), 0.1)(time)
    fast, slow = (sines(generator, 2, (1.0, 3.0), level)(time) for level in (0.15, 0.15 * SLOW))
    return np.where(time // TURN % 2 == 0, slow, fast)


@dataclass(frozen=True)
class _Hidden:
    """What a damper hides, the same in every run: the amounts are relative to the run that is fitted."""

    f_c: float
    gap: float
    s: float
    dahl: bool

    @classmethod
    def of(cls, row: str, amounts: Mapping[str, float], fitted: _Way) -> _Hidden:
        f_c = amounts["share"] * rms(fitted.own)
        if row == "stiff":
            s = float(np.abs(fitted.v).max()) * DT / amounts["stiffness"]
            return cls(f_c, 0.0, s, amounts["form"] < 1)
        deviation = float(fitted.q.std())
        return cls(f_c, amounts.get("gap", 0.0) * deviation, amounts.get("s", 0.0) * deviation, dahl=False)

    def effort(self, row: str, way: _Way) -> Array:
        """Effort (m,) along ``way``."""
        if row == "scaled_friction":
            return self.f_c * way.level * np.sign(way.v)
        if row == "friction_behind_gap":
            reach = self.gap + self.s
            x = _followed(way.q, lambda x, dq: min(max(x + dq, -reach), reach))
            return self.f_c * np.sign(x) * np.maximum(np.abs(x) - self.gap, 0.0) / self.s
        law = _dahl if self.dahl else _bouc_wen
        return self.f_c * _followed(way.q, lambda z, dq: law(z, dq / self.s))


def _followed(q: Array, step: Callable[[float, float], float]) -> Array:
    """A state (m,) that depends on the path alone, from zero: ``step(state, dq)`` is the next."""
    return np.array(list(accumulate(np.diff(q).tolist(), step, initial=0.0)))


def _dahl(z: float, travel: float) -> float:
    """``dz/dx = 1 - z sign(dx)`` over ``travel``, both in pre-sliding lengths."""
    side = math.copysign(1.0, travel)
    return side - (side - z) * math.exp(-abs(travel))


def _bouc_wen(z: float, travel: float) -> float:
    """``dz/dx = 1 - sigma sign(dx) |z| z + (sigma - 1) z²``: a tangent up to z = 0, then a hyperbolic one."""
    side = math.copysign(1.0, travel)
    z, left = side * z, abs(travel)
    if z < 0:
        root = math.sqrt(2 * SIGMA - 1)
        to_zero = math.atan(-root * z) / root
        if left < to_zero:
            return side * math.tan(root * left + math.atan(root * z)) / root
        z, left = 0.0, left - to_zero
    return side * math.tanh(left + math.atanh(min(z, 1 - 1e-15)))


def _through_cell(force: Array) -> Array:
    """The load cell's reading (m,) of ``force`` (m,), a straight line within a piece; settled at first."""
    h = DT / PIECES
    kept = math.exp(-h / TAU)
    mean = (1 - kept) * TAU / h
    b = [1 - mean, mean - kept]
    return lfilter(b, [1.0, -kept], force, zi=[force[0] * (1 - b[0])])[0]
