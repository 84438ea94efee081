"""Whether a model predicts better than a constant does, over the held-out horizons.

An effect that holds a bad model still takes most of its error, and explains nothing. The initial state of
each horizon is fitted. So the constant is the mean of the horizon.

Source: the coefficient of determination, R² <= 0: Ljung (1999), System Identification, 2nd ed., sec. 16.4.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from hybridid.trace.horizons.split import Split
from hybridid.trace.refits.refitted import Refit

Array = NDArray[np.float64]


def error_of_constants(final: Refit, split: Split) -> Array:
    """RMS error (n_y,) of the mean of each held-out horizon, in the outputs' units."""
    windows = final.problem(split).on(split.held_out).windows
    seen = np.where(windows.cells, windows.outputs, np.nan)
    return np.asarray(np.sqrt(np.nanmean((seen - np.nanmean(seen, axis=1, keepdims=True)) ** 2, axis=(0, 1))))


def no_better_than_nothing(final: Refit, split: Split) -> bool:
    """Whether constants err less than ``final`` does, in every output."""
    return bool(np.all(final.score.rmse > error_of_constants(final, split)))
