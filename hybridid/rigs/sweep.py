"""``LinearSweep``: a sine whose frequency rises linearly; ``VelocityFilter``: speed from an encoder."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.signal import savgol_coeffs

from hybridid.rigs.laws import RigError

Array = NDArray[np.float64]


@dataclass(frozen=True)
class LinearSweep:
    """``r = amplitude sin(phase + 2 pi (first t + (last - first) t^2 / (2 duration)))``, then on at ``last``.

    amplitude [rad or m], first and last frequency [Hz], duration of the rise [s], phase [rad].
    """

    amplitude: float
    first: float
    last: float
    duration: float
    phase: float = 0.0

    def __post_init__(self) -> None:
        if not (0 <= self.first <= self.last < math.inf and 0 < self.duration < math.inf):
            raise RigError(f"{self}: frequencies must rise from 0 or more, duration must be above 0")

    def position(self, time: Array) -> Array:
        """Reference at ``time`` (n,) [s]."""
        rising = np.minimum(time, self.duration)
        cycles = self.first * rising + 0.5 * (self.last - self.first) / self.duration * rising**2
        return self.amplitude * np.sin(self.phase + 2 * np.pi * (cycles + self.last * (time - rising)))


@dataclass(frozen=True)
class VelocityFilter:
    """The slope of a polynomial of degree ``degree`` fitted to ``window`` samples around each one.

    It has no delay. With five samples and degree four, its gain at a tenth of the sampling frequency is
    accurate to 0.4 %.
    Source: Savitzky, Golay (1964), Analytical Chemistry 36(8).
    """

    window: int = 5
    degree: int = 4

    def __post_init__(self) -> None:
        if not (self.window % 2 == 1 and 1 <= self.degree < self.window):
            raise RigError(f"{self}: the window must be odd and longer than the degree, which is 1 or more")

    @property
    def reach(self) -> int:
        """Number of samples that it needs on each side."""
        return self.window // 2

    def __call__(self, position: Array, dt: float) -> Array:
        """Velocity (n,) of ``position`` (n + 2 reach,), samples ``dt`` [s] apart."""
        weights = savgol_coeffs(self.window, self.degree, deriv=1, delta=dt)
        return np.convolve(position, weights, mode="valid")
