"""The values of a hidden law: from an amount, from what was drawn, and from how the machine moves without it.

The amount A is an effort [N]: to first order the law's effort is A at the port's typical motion. Lengths,
speeds and times of a law are multiples of the port's own, log-uniform between the bounds stated here.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from benchmarks.drawn.excitation import between
from benchmarks.drawn.shapes import Factor

Array = NDArray[np.float64]
Values = dict[str, float]
EASED = 0.8
"""The most that a hidden law takes from the machine's own friction, or from its drive."""


@dataclass(frozen=True)
class Moving:
    """How a port moves, without what is hidden: position (spread, low, high), RMS speed and acceleration,
    RMS effort of the drive there, duration and sampling time of the record. ``viscous`` is the machine's own
    coefficient there: what eases the motion takes at most ``EASED`` of it, or the contact would push."""

    spread: float
    low: float
    high: float
    speed: float
    acceleration: float
    effort: float
    duration: float
    dt: float
    viscous: float

    @classmethod
    def of(cls, position: Array, velocity: Array, effort: Array, dt: float, viscous: float) -> Moving:
        acceleration = np.gradient(velocity, dt)
        return cls(
            spread=float(position.std()),
            low=float(position.min()),
            high=float(position.max()),
            speed=rms(velocity),
            acceleration=rms(acceleration),
            effort=rms(effort),
            duration=dt * (len(position) - 1),
            dt=dt,
            viscous=viscous,
        )

    @property
    def reach(self) -> float:
        """From the lowest to the highest position."""
        return self.high - self.low

    @property
    def time(self) -> float:
        """A time of the motion: its spread over its speed."""
        return self.spread / self.speed

    def easing(self, a: float) -> float:
        """A coefficient of viscous friction that is less, by ``a`` at the RMS speed."""
        return min(a / self.speed, EASED * self.viscous)

    def place(self, chance: float) -> float:
        """A position in the middle half of the reach."""
        return self.low + self.reach * (0.25 + 0.5 * chance)


def rms(x: Array) -> float:
    return float(np.sqrt(np.mean(x**2)))


Recipe = Callable[[float, Sequence[float], Moving], Values]


def _lugre(a: float, c: Sequence[float], at: Moving) -> Values:
    stiffness = a / (between(c[0], 0.005, 0.03) * at.reach)
    return {
        "f_c": a, "f_s": a * between(c[1], 1.2, 2.0), "v_s": between(c[2], 0.1, 0.4) * at.speed,
        "sigma_0": stiffness, "sigma_1": 0.01 * at.time * stiffness,
    }  # fmt: skip


def _behind(a: float, c: Sequence[float], at: Moving) -> Values:
    """A mass behind a spring, a good deal faster than the machine moves."""
    frequency = between(c[0], 4.0, 12.0) / (2 * math.pi * at.time)
    return {"mass": a / at.acceleration, "frequency": frequency, "damping": between(c[1], 0.03, 0.3)}


RECIPES: Mapping[str, Recipe] = {
    "coulomb": lambda a, c, at: {"f_c": a},
    "viscous": lambda a, c, at: {"f_v": a / at.speed},
    "stribeck": lambda a, c, at: {"amplitude": a, "velocity": between(c[0], 0.1, 0.5) * at.speed},
    "asymmetric_viscous": lambda a, c, at: {"difference": 2 * at.easing(a)},
    "asymmetric_damper": lambda a, c, at: {
        "difference": 2 * at.easing(a), "knee": between(c[0], 0.05, 0.3) * at.speed
    },
    "quadratic_drag": lambda a, c, at: {"c": a / at.speed**2},
    "linear_stiffness": lambda a, c, at: {"k": a / at.spread, "q_0": 0.0},
    "cubic_stiffness": lambda a, c, at: {"k_3": a / at.spread**3, "q_0": 0.5 * (at.low + at.high)},
    "cogging": lambda a, c, at: {
        "amplitude": a, "pitch": between(c[0], 0.06, 0.3) * at.reach, "phase": 2 * math.pi * c[1]
    },
    "position_friction": lambda a, c, at: {"slope": a / at.reach, "q_0": at.low},
    "friction_drift": lambda a, c, at: {"rate": 2 * a / at.duration},
    "end_stop": lambda a, c, at: {"k": 5 * a / at.reach, "d": at.low + at.reach * between(c[0], 0.55, 0.8)},
    "dahl": lambda a, c, at: {"amplitude": a, "stiffness": a / (between(c[0], 0.005, 0.04) * at.reach)},
    "lugre": _lugre,
    "bouc_wen": lambda a, c, at: {
        "f_c": a, "s": between(c[0], 0.02, 0.1) * at.reach, "sigma": between(c[1], 0.6, 0.9)
    },
    "maxwell": lambda a, c, at: {"k": a / at.spread, "tau": between(c[0], 0.3, 2.0) * at.time},
    "flexible_mode": _behind,
    "backlash": lambda a, c, at: {**_behind(a, c, at), "gap": between(c[2], 5e-4, 1e-2) * at.reach},
    "input_gain": lambda a, c, at: {"gain": 1 - a / at.effort},
    # outside the library
    "load_friction": lambda a, c, at: {"mu": a / at.effort, "load": 0.0},
    "two_sided_load_friction": lambda a, c, at: {
        "mu": a / at.effort, "load": 0.0, "ratio": between(c[0], 0.15, 0.6)
    },
    "following_friction": lambda a, c, at: {
        "mu": a / at.effort, "load": 0.0, "tau": between(c[0], 0.2, 1.0) * at.time
    },
    "varying_inertia": lambda a, c, at: {
        "dm": a / at.acceleration, "load": 0.0, "q_0": at.place(c[0]),
        "width": between(c[1], 0.1, 0.35) * at.reach,
    },
    "friction_behind_gap": lambda a, c, at: {
        "f_c": a, "gap": between(c[0], 0.05, 0.2) * at.reach, "s": between(c[1], 0.01, 0.05) * at.reach
    },
    "hardening_hysteresis": lambda a, c, at: {
        "f_c": a, "s": between(c[0], 0.5, 1.5) * at.spread, "gamma": 0.8, "delta": -1.1
    },
    "eddy_brake": lambda a, c, at: {"peak": a, "v_c": between(c[0], 0.3, 1.0) * at.speed},
    # it grips more as it warms: the league's own, which eases, would soon push
    "heating": lambda a, c, at: {
        "c": -a / (at.speed * between(c[0], 0.1, 0.4) * at.duration),
        "tau": between(c[0], 0.1, 0.4) * at.duration,
    },
    "dent": lambda a, c, at: {
        "amplitude": a, "q_0": at.place(c[0]), "width": between(c[1], 0.03, 0.12) * at.reach
    },
    "position_damping": lambda a, c, at: {"c": a / (at.spread * at.speed)},
    "blow_off": lambda a, c, at: {
        "c": at.easing(a), "v_b": between(c[0], 0.3, 1.0) * at.speed
    },
}  # fmt: skip


def composed_values(a: float, factors: Sequence[Factor], c: Sequence[float], at: Moving) -> dict[str, float]:
    """Values of ``f g`` at amplitude ``a``: the first two chances are those of f, the others of g."""
    tau_a = 4 * at.dt if any(one.variable == "acceleration" for one in factors) else at.duration
    tau_r = 0.2 * at.duration
    made = {"amplitude": a, "load": 0.0, "tau_a": tau_a, "tau_r": tau_r}
    for of, one, chances in zip("fg", factors, (c[:2], c[2:]), strict=True):
        place, scale = _where(one, chances, at, tau_r)
        made |= one.numbers(of, place, scale)
        if of == "f" and one.variable == "load":  # a drive that pulls less, not backwards
            made["amplitude"] = max(min(a, EASED * scale), -EASED * scale)
    return made


def _where(one: Factor, c: Sequence[float], at: Moving, tau_r: float) -> tuple[float, float]:
    """Place and scale of a factor over its variable."""
    if one.variable == "position":
        return at.place(c[0]), between(c[1], 0.1, 0.3) * at.reach
    if one.variable == "time":
        place = (0.3 + 0.4 * c[0]) * at.duration if one.shape == "step" else 0.0
        return place, between(c[1], 0.1, 0.5) * at.duration
    scale = {
        "velocity": at.speed,
        "load": at.effort,
        "acceleration": at.acceleration,
        "travel": at.speed * tau_r,
    }[one.variable]
    return 0.0, scale * between(c[1], 0.3, 1.0)
