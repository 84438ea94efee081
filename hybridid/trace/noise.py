"""The noise floor of a record: below it no model can explain anything."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.signal import savgol_coeffs, savgol_filter

from hybridid.records.record import Record

Array = NDArray[np.float64]
HALF_WIDTH, ORDER = 4, 3


def noise_level(record: Record) -> Array:
    """Standard deviation of each output's sample noise, shape (n_y,).

    The larger of the quantisation step over sqrt(12) and what a local cubic over
    ``2 HALF_WIDTH + 1`` samples leaves, corrected for what the cubic itself absorbs. The
    median makes it a floor: jerks in the motion do not raise it.
    """
    return np.array([max(_quantisation(y) / np.sqrt(12), _local(y)) for y in record.outputs.T])


def _quantisation(y: Array) -> float:
    """Smallest difference between levels, when the levels lie on a grid; else 0."""
    steps = np.unique(np.abs(np.diff(np.unique(y))))
    steps = steps[steps > 1e-12 * np.ptp(y)]
    if not len(steps):
        return 0.0
    step = float(steps[0])
    on_grid = np.abs(y / step - np.round(y / step)) < 0.05
    return step if on_grid.mean() > 0.99 and np.ptp(y) / step < 1e9 else 0.0


def _local(y: Array) -> float:
    width = 2 * HALF_WIDTH + 1
    if len(y) < 3 * width:
        return 0.0
    rest = (y - savgol_filter(y, width, ORDER))[width:-width]
    kept = 1.0 - savgol_coeffs(width, ORDER)[HALF_WIDTH]
    # The median of |rest| is 0.6745 standard deviations of Gaussian noise.
    return float(np.median(np.abs(rest)) / 0.6745 / np.sqrt(kept))
