"""The stretches over which a network runs free: windows from measured errors, or whole records from zero."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hybridid.residuals.samples import Samples

Array = NDArray[np.float64]
Index = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Stretches:
    """Runs of grid samples, first and end (r, 2), each from the errors ``before`` it (r, lags), the newest
    first; ``counts`` (m,) is 1 for the samples whose error counts, else 0."""

    runs: Index
    before: Array
    counts: Array

    @classmethod
    def whole(cls, samples: Samples, lags: int, blocks: Sequence[tuple[int, int]]) -> Stretches:
        """Every record from an error of zero, as in use; what counts are these ``blocks``."""
        return cls(_runs(samples.pieces), np.zeros((len(samples.pieces), lags)), _counts(samples, blocks))

    @classmethod
    def windows(cls, samples: Samples, lags: int, runs: Sequence[tuple[int, int]]) -> Stretches:
        """Windows that do not overlap, each from measured errors."""
        bounds = _runs(runs)
        before = samples.doubles[0][bounds[:, :1] - 1 - np.arange(lags)]
        return cls(bounds, before, _counts(samples, runs))


def training(samples: Samples, lags: int, horizon: int | None) -> Stretches:
    """What a horizon trains on: adjacent windows that cover the training blocks, or whole records (None).

    The last window of a block may be shorter.
    """
    split = samples.split
    if horizon is None:
        return Stretches.whole(samples, lags, split.train)
    firsts = [(k, b) for a, b in split.train for k in range(a + samples.reach, b, horizon)]
    return Stretches.windows(samples, lags, [(k, min(k + horizon, b)) for k, b in firsts])


def _runs(bounds: Sequence[tuple[int, int]]) -> Index:
    return np.array(bounds, dtype=np.int64).reshape(-1, 2)


def _counts(samples: Samples, blocks: Sequence[tuple[int, int]]) -> Array:
    counts = np.zeros(len(samples.doubles[0]))
    for first, end in blocks:
        counts[first:end] = 1.0
    return counts
