"""``BangBang``: a reference position of point-to-point moves with bang-bang accelerations.

    q'' = +a until the speed is reached, 0 at constant speed, -a until the target is reached

A move too short for its speed has no phase of constant speed: its peak speed is sqrt(a d). Source:
Khalil, Dombre (2004), "Modeling, identification and control of robots", chapter 13.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hybridid.rigs.laws import RigError

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Move:
    """To position ``to`` [m] at ``speed`` [m/s] with ``acceleration`` [m/s^2], then ``rest`` [s].

    Raises:
        RigError: if speed or acceleration is not positive or the rest is negative.
    """

    to: float
    speed: float
    acceleration: float
    rest: float = 0.0

    def __post_init__(self) -> None:
        if min(self.speed, self.acceleration) <= 0 or self.rest < 0:
            raise RigError(f"{self}: speed and acceleration must be above 0, rest not below 0")

    def segments(self, start: float) -> tuple[tuple[float, float], ...]:
        """(duration [s], acceleration [m/s^2]) from ``start`` [m] at rest to rest."""
        distance = abs(self.to - start)
        direction = math.copysign(1.0, self.to - start)
        speed = min(self.speed, math.sqrt(self.acceleration * distance))
        ramp = speed / self.acceleration
        cruise = distance / speed - ramp if distance else 0.0
        a = direction * self.acceleration
        return (ramp, a), (cruise, 0.0), (ramp, -a), (self.rest, 0.0)


@dataclass(frozen=True)
class BangBang:
    """Rest at 0 for ``lead_in`` [s], then the ``moves`` periodically. The last move must return to 0."""

    lead_in: float
    moves: tuple[Move, ...]

    def __post_init__(self) -> None:
        if not self.moves or self.moves[-1].to != 0.0 or all(move.to == 0.0 for move in self.moves):
            raise RigError("reference: the moves must leave position 0 and the last must return to it")

    @property
    def cycle(self) -> tuple[tuple[float, float], ...]:
        """(duration [s], acceleration [m/s^2]) of every segment of one period."""
        starts = (0.0, *(move.to for move in self.moves[:-1]))
        rounds = (move.segments(start) for start, move in zip(starts, self.moves, strict=True))
        return tuple(segment for segments in rounds for segment in segments)

    @property
    def period(self) -> float:
        """Duration of all moves together [s]."""
        return sum(duration for duration, _ in self.cycle)

    def position(self, time: Array) -> Array:
        """Reference [m] at ``time`` (n,) [s]: exact parabolas between the switching instants."""
        duration, a = np.array(self.cycle).T
        switch = np.concatenate([[0.0], np.cumsum(duration)[:-1]])
        v = np.concatenate([[0.0], np.cumsum(duration * a)[:-1]])
        q = np.concatenate([[0.0], np.cumsum(v * duration + 0.5 * a * duration**2)[:-1]])
        since = np.maximum(np.asarray(time) - self.lead_in, 0.0) % self.period
        i = np.searchsorted(switch, since, side="right") - 1
        tau = since - switch[i]
        return q[i] + v[i] * tau + 0.5 * a[i] * tau**2
