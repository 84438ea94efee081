"""The digital parts of a rig: encoder, controllers, drive. Plain Python, one sample at a time.

Lengths are in m and forces in N; for a rotary machine, read rad and N·m.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hybridid.rigs.laws import RigError

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Encoder:
    """``measured = resolution * round((position + noise) / resolution)``.

    ``resolution`` [m] is one count; ``noise_std`` [m] is Gaussian and independent from sample to
    sample, before the counts are formed.
    """

    resolution: float
    noise_std: float = 0.0

    def __post_init__(self) -> None:
        if not (self.resolution > 0 and self.noise_std >= 0 and math.isfinite(self.noise_std)):
            raise RigError(f"{self}: resolution must be above 0 and noise_std not below 0")

    def noise(self, n: int, generator: np.random.Generator) -> Array:
        """Noise [m] of ``n`` samples."""
        return self.noise_std * generator.standard_normal(n)

    def read(self, position: float) -> float:
        """Quantised position [m]; ``position`` [m] already contains the noise."""
        return self.resolution * math.floor(position / self.resolution + 0.5)


@dataclass(frozen=True)
class Drive:
    """``force = gain * clip(command, -saturation, saturation)``; gain [N/V], saturation [V]."""

    gain: float
    saturation: float

    def __post_init__(self) -> None:
        if not (math.isfinite(self.gain) and self.gain != 0 and self.saturation > 0):
            raise RigError(f"{self}: gain must not be 0 and saturation must be above 0")

    def voltage(self, command: float) -> float:
        """The voltage [V] that reaches the motor."""
        return min(max(command, -self.saturation), self.saturation)


@dataclass(frozen=True)
class CascadedPD:
    """``command = kp kv (reference - position) - kv velocity``; kp [1/s], kv [V s/m].

    The velocity is the backward difference of the mean of the last two positions.
    Source: Janot, Gautier, Brunot (2019), Eq. (6) and Section 2.2.
    """

    kp: float
    kv: float

    def command(self, reference: float, positions: tuple[float, float, float], dt: float) -> float:
        """Command [V] from the newest three measured positions [m], newest first, ``dt`` [s] apart."""
        newest, previous, oldest = positions
        velocity = (0.5 * (newest + previous) - 0.5 * (previous + oldest)) / dt
        return self.kp * self.kv * (reference - newest) - self.kv * velocity


@dataclass(frozen=True)
class PD:
    """``command = kp e + kd e'``, e = reference - position; kp [N/m], kd [N s/m].

    The error's rate is its backward difference.
    """

    kp: float
    kd: float

    def command(self, error: float, previous: float, dt: float) -> float:
        """Command [N] from the newest two errors [m], ``dt`` [s] apart."""
        return self.kp * error + self.kd * (error - previous) / dt
