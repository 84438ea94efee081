"""The inputs of the network: scaled past values on its own time grid.

The network works on every ``every``-th sample. An input there is its mean up to the next such sample, because
the mean is what drives the machine. Error and gray-box output are the values at the sample.
``every = 1`` is the thesis' NARX.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hybridid.residuals.orders import Orders
from hybridid.residuals.series import ErrorSeries, Surroundings

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Scaling:
    """``(value - mean) / size`` scales signals to order one; the error is only divided."""

    error: float
    input_mean: tuple[float, ...]
    input_size: tuple[float, ...]
    gray_mean: float
    gray_size: float

    @classmethod
    def of(cls, series: Sequence[ErrorSeries], every: int) -> Scaling:
        """The scaling for the records that train the network.

        Raises:
            ValueError: if the error of the gray box is zero.
        """
        inputs = np.concatenate([on_grid(s.seen.inputs, every) for s in series])
        gray = np.concatenate([s.seen.gray for s in series])
        errors = np.concatenate([s.error for s in series])
        error = float(np.sqrt(np.mean(errors[np.isfinite(errors)] ** 2)))
        if not error > 0:
            raise ValueError(f"the gray box leaves no error of {series[0].seen.output}: nothing to learn")
        return cls(
            error=error,
            input_mean=tuple(map(float, inputs.mean(axis=0))),
            input_size=tuple(map(_size, inputs.T)),
            gray_mean=float(gray.mean()),
            gray_size=_size(gray),
        )


def _size(samples: Array) -> float:
    return float(samples.std()) or 1.0


def on_grid(inputs: Array, every: int) -> Array:
    """Inputs (n, n_u) averaged over each grid interval, (ceil(n / every), n_u)."""
    starts = np.arange(0, len(inputs), every)
    counts = np.diff(np.append(starts, len(inputs)))
    return np.add.reduceat(inputs, starts, axis=0) / counts[:, None]


def lagged(samples: Array, order: int, before: float) -> Array:
    """Row t holds ``samples[t-1] .. samples[t-order]``, (m, order); ``before`` stands for earlier samples."""
    padded = np.concatenate([np.full(order, before), samples])
    columns = [padded[order - k : order - k + len(samples)] for k in range(1, order + 1)]
    return np.stack(columns, axis=1) if columns else np.empty((len(samples), 0))


def exogenous(seen: Surroundings, piece: slice, orders: Orders, scaling: Scaling, every: int) -> Array:
    """Scaled past inputs and gray-box outputs over one piece on the network's grid, (m, d).

    Before the piece begins, each signal counts as constant.
    """
    inputs = (on_grid(seen.inputs[piece], every) - scaling.input_mean) / scaling.input_size
    gray = (seen.gray[piece][::every] - scaling.gray_mean) / scaling.gray_size
    signals = np.column_stack([inputs, gray]).T
    columns = [lagged(s, order, s[0]) for s, order in zip(signals, orders.exogenous, strict=True)]
    return np.hstack(columns)


def scaled_error(series: ErrorSeries, piece: slice, scaling: Scaling, every: int) -> Array:
    """The error over one piece on the network's grid, (m,)."""
    return series.error[piece][::every] / scaling.error
