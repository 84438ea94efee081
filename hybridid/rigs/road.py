"""A bump, a driver and an inertial sensor: the parts of a vehicle's run over an obstacle."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hybridid.rigs.laws import RigError

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Bump:
    """``u = height sin^2(pi x / length)`` over its ``length`` [m], else 0; height [m]."""

    height: float
    length: float

    def __post_init__(self) -> None:
        if not (self.height >= 0 and 0 < self.length < math.inf):
            raise RigError(f"{self}: height must not be below 0, length must be above 0")

    def __call__(self, x: Array) -> Array:
        """Road height [m] at ``x`` (n,) [m] from the foot of the bump."""
        nearer_foot = np.minimum(x, self.length - x)  # exactly zero outside the bump
        return self.height * np.sin(np.pi * np.maximum(nearer_foot, 0.0) / self.length) ** 2


@dataclass(frozen=True)
class Driver:
    """``speed = nominal (1 + w - sag s e^(1 - s))``, s = time since the bump over ``recovery``, if positive.

    ``w`` is an Ornstein-Uhlenbeck process with standard deviation ``wander`` and correlation time
    ``memory`` [s]. ``sag`` is the relative loss of speed at the bump, which the driver makes up for within
    ``recovery`` [s].
    """

    wander: float = 0.0
    memory: float = 1.0
    sag: float = 0.0
    recovery: float = 0.5

    def __post_init__(self) -> None:
        if not (self.wander >= 0 and 0 <= self.sag < 1 and min(self.memory, self.recovery) > 0):
            raise RigError(f"{self}: wander and sag must be 0 or more, memory and recovery above 0")

    def speed(self, nominal: float, since_bump: Array, step: float, generator: np.random.Generator) -> Array:
        """Speed (n,) [m/s] at instants ``step`` [s] apart; the bump begins at ``since_bump`` (n,) [s] = 0."""
        kept = math.exp(-step / self.memory)
        kicks = self.wander * generator.standard_normal(len(since_bump))
        kicks[1:] *= math.sqrt(1 - kept**2)
        wander = np.empty_like(kicks)
        before = 0.0
        for k, kick in enumerate(kicks):
            wander[k] = before = kept * before + kick
        s = np.maximum(since_bump, 0.0) / self.recovery
        return nominal * (1 + wander - self.sag * s * np.exp(1 - s))


@dataclass(frozen=True)
class Sensor:
    """``measured = true + bias + noise + vibration sin(2 pi frequency t + phase)``; of a channel's own unit.

    ``noise`` is Gaussian, independent from sample to sample; the phase is drawn anew for each run.
    ``frequency`` [Hz] is that of the running engine.
    """

    noise: float
    bias: float = 0.0
    vibration: float = 0.0
    frequency: float = 30.0

    def __post_init__(self) -> None:
        if not (self.noise >= 0 and math.isfinite(self.noise + self.bias + self.vibration)):
            raise RigError(f"{self}: noise must not be below 0, and all of it finite")

    def read(self, true: Array, time: Array, generator: np.random.Generator) -> Array:
        """The recorded signal (n,) for the true signal ``true`` (n,) at ``time`` (n,) [s]."""
        phase = generator.uniform(0, 2 * np.pi)
        noise = self.noise * generator.standard_normal(len(true))
        return true + self.bias + noise + self.vibration * np.sin(2 * np.pi * self.frequency * time + phase)
