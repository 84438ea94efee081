"""What a record says of a model's states: smoothed outputs and their derivatives."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.signal import savgol_filter

from hybridid.model import Model
from hybridid.records.record import Record

Array = NDArray[np.float64]
HALF_WIDTH = 10
"""Samples on each side that the local polynomial uses."""
ORDER = 3
"""Degree of the local polynomial: of the output itself 3, so that velocity is quadratic."""


def smoothed_derivative(samples: Array, dt: float, derivative: int, half_width: int = HALF_WIDTH) -> Array:
    """Savitzky-Golay estimate of the ``derivative``-th time derivative, shape (n,)."""
    n = len(samples)
    width = min(2 * half_width + 1, n - (n + 1) % 2)
    order = min(ORDER, width - 1)
    if derivative > order:
        return np.zeros(n)
    return savgol_filter(samples, width, order, deriv=derivative, delta=dt, mode="interp")


def observed(model: Model) -> tuple[bool, ...]:
    """For each state, whether an output or a derivative of one shows it."""
    return tuple(state.observed_by is not None for state in model.states)


def measured_states(model: Model, record: Record, half_width: int = HALF_WIDTH) -> Array:
    """States from the record, shape (n, n_x); zero where no output shows them."""
    states = np.zeros((record.n, len(model.states)))
    for j, state in enumerate(model.states):
        if state.observed_by is not None:
            samples = record.output(state.observed_by)
            states[:, j] = smoothed_derivative(samples, record.dt, state.derivative, half_width)
    return states
