"""Fewer points for the same picture: a long line is drawn through the extremes of short blocks."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def extremes(y: Array, blocks: int) -> NDArray[np.intp]:
    """Indices of the first, the last, and the smallest and largest sample of each block.

    Min-max decimation: with one block for each printed dot, the visible envelope is that of the
    whole signal, spikes included, from at most ``2 blocks + 4`` samples.
    Non-finite samples are kept only if a block has no others.
    """
    n = len(y)
    if n <= 2 * blocks + 4:
        return np.arange(n)
    size = -(-n // blocks)
    whole = n // size * size
    starts = np.arange(0, whole, size)
    finite = np.isfinite(y)
    low = np.where(finite, y, np.inf)
    high = np.where(finite, y, -np.inf)
    keep = [
        starts + low[:whole].reshape(-1, size).argmin(axis=1),
        starts + high[:whole].reshape(-1, size).argmax(axis=1),
        np.array([0, n - 1]),
    ]
    if whole < n:
        keep.append(whole + np.array([low[whole:].argmin(), high[whole:].argmax()]))
    return np.unique(np.concatenate(keep))


def thin(x: Array, y: Array, blocks: int) -> tuple[Array, Array]:
    """``x`` and ``y`` at the extremes of ``y``; non-finite values become gaps (NaN)."""
    kept = extremes(y, blocks)
    return x[kept], np.where(np.isfinite(y[kept]), y[kept], np.nan)


def broken(x: Array, y: Array, starts: Array) -> tuple[Array, Array]:
    """The same line with a gap before each of ``starts``, so that no segment joins two horizons."""
    at = np.searchsorted(x, starts)
    at = at[(at > 0) & (at < len(x))]
    return np.insert(x, at, x[at]), np.insert(y, at, np.nan)
