"""Random excitations: moves from place to place, sines, multisines, forces that switch, tracks of bumps.

Each is drawn from a generator of its own, so that the same seed gives the same signal.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from benchmarks.league.machines import Track
from hybridid.rigs.trajectory import BangBang, Move

Array = NDArray[np.float64]
STROKE = 0.22
"""Longest way of the carriage from its start [m]."""


def between(chance: float, low: float, high: float) -> float:
    """Where a number drawn uniformly from 0 to 1 falls between ``low`` and ``high``, log-uniformly."""
    return float(low * (high / low) ** chance)


def log_uniform(generator: np.random.Generator, low: float, high: float) -> float:
    return between(generator.uniform(), low, high)


@dataclass(frozen=True)
class Sines:
    """``sum of a_k sin(2 pi f_k t + phase_k)``; ``lines`` are (a, f [Hz], phase). ``rests``: from zero.

    ``switches``: the sum's sign times its RMS, a bang-bang force.
    """

    lines: tuple[tuple[float, float, float], ...]
    rests: bool = False
    switches: bool = False

    def __call__(self, time: Array) -> Array:
        a, f, phase = np.array(self.lines).T
        made = np.sin(2 * np.pi * time[:, None] * f + phase) @ a
        if self.switches:
            return np.where(made < 0, -1.0, 1.0) * np.sqrt(0.5 * a @ a)
        return made - a @ np.sin(phase) if self.rests else made


def sines(
    generator: np.random.Generator, count: int, band: tuple[float, float], rms: float, **how: bool
) -> Sines:
    """``count`` sines of random frequency in ``band`` [Hz], phase, and amplitude within a factor of three."""
    weights = np.array([log_uniform(generator, 1.0, 3.0) for _ in range(count)])
    weights *= rms * np.sqrt(2 / (weights @ weights))
    lines = [
        (float(a), log_uniform(generator, *band), float(generator.uniform(0, 2 * np.pi))) for a in weights
    ]
    return Sines(tuple(lines), **how)


def moves(generator: np.random.Generator) -> BangBang:
    """Seven moves of the carriage with bang-bang accelerations, the last back to its start."""
    place, made = 0.0, []
    for k in range(7):
        target = 0.0
        while k < 6 and abs(target - place) < 0.02:
            target = float(generator.uniform(0.0, STROKE))
        made.append(Move(target, log_uniform(generator, 0.04, 0.25), log_uniform(generator, 0.5, 1.4)))
        place = target
    return BangBang(0.02, tuple(made))


def track(generator: np.random.Generator) -> Track:
    """Bumps one after another over some 40 m: 3 to 12 cm high, 0.9 to 4 m long."""
    foot, bumps = 0.0, []
    while foot < 40.0:
        length = log_uniform(generator, 0.9, 4.0)
        bumps.append((foot, log_uniform(generator, 0.03, 0.12), length))
        foot += length + log_uniform(generator, 2.0, 6.0)
    return Track(tuple(bumps))
