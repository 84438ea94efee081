"""``Noise``: the level of the sensors' noise, bounded from above by the records and by a model's errors.

The records show it where the motion is smooth from sample to sample (``hybridid.records.sensor_noise``).
Where the motion is nearly as fast as the samples, they show motion as well. A model takes motion away and
leaves the noise, which it cannot know beforehand. So the innovations of its errors are a second bound: an
error e = d + n, d from a fault of the model and n a white noise independent of it, has innovations of at
least the variance of n, whatever d is. The smaller bound counts, but no less than the rounding.

Source: Kolmogorov (1941), Szego (1920): the variance of the innovations is exp of the mean of ln S, S the
spectral density; S >= S_n everywhere. Ljung (1999), System Identification, 2nd ed., sec. 3.2.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hybridid.records.record import Record
from hybridid.records.sensor_noise import noise_level, rounding
from hybridid.trace.horizons.score import Score

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Noise:
    """Standard deviations of each output, (n_y,), in its unit: the most noise that the records ``show``, and
    their ``rounding``."""

    show: Array
    rounding: Array

    @classmethod
    def of(cls, records: Sequence[Record]) -> Noise:
        """The largest of all ``records``."""
        levels = ([of_one(record) for record in records] for of_one in (noise_level, rounding))
        return cls(*(np.max(each, axis=0) for each in levels))

    def beside(self, score: Score) -> Array:
        """The noise level (n_y,) where a model has the held-out errors of ``score``."""
        return np.maximum(self.rounding, np.minimum(self.show, score.innovation))
