"""Tests of a residual: autocorrelation, whiteness, correlation with the inputs.

The residual of a complete model is white and uncorrelated with past inputs. Source:
Ljung (1999), System Identification, sec. 16.6; Ljung, Box (1978), Biometrika 65(2).

Over horizons of less than about a hundred samples, the initial state fitted to each horizon correlates even a
white residual, and the test of whiteness rejects too often.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import signal, stats

from hybridid.records.record import Record
from hybridid.validation.predict import Prediction

Array = NDArray[np.float64]
LEVEL = 0.99


@dataclass(frozen=True)
class ResidualTests:
    """Correlations of one output's residual.

    ``lags`` (l,) in s for ``autocorrelation`` (l,); ``input_lags`` (2 l - 1,) in s for
    ``cross_correlation`` by input, positive where the residual follows the input.
    ``band`` and ``input_bands`` are the limits of a white, independent residual.
    ``p_white`` is the Ljung-Box p-value.
    """

    record: str
    output: str
    provenance: str
    lags: Array
    autocorrelation: Array
    band: float
    p_white: float
    input_lags: Array
    cross_correlation: dict[str, Array]
    input_bands: dict[str, float]


def residual_tests(prediction: Prediction, record: Record, lags: int = 50) -> list[ResidualTests]:
    """Tests of each output's residual up to ``lags`` samples; nothing correlates with an input that stands
    still."""
    lags = min(lags, len(prediction.time) // 4)
    along = slice(len(prediction.time)) if prediction.rows is None else slice(prediction.rows[-1] + 1)
    running = np.flatnonzero(np.ptp(record.inputs[along], axis=0) > 0).tolist()
    inputs = record.inputs[along, running]
    names = [record.input_channels[k].name for k in running]
    return [
        _tests(prediction, column, inputs, names, record.dt, lags)
        for column in range(prediction.measured.shape[1])
    ]


def _tests(
    prediction: Prediction, column: int, inputs: Array, names: list[str], dt: float, lags: int
) -> ResidualTests:
    kept, rows = prediction.samples_of(column)
    error = prediction.error[kept, column] - prediction.error[kept, column].mean()
    n = len(error)
    pairs, spans = n - np.arange(1, lags + 1), 1.0
    if rows is not None:
        error, pairs = _with_holes(error, rows, len(inputs), lags)
        spans = len(error) / n
    auto = correlation(error, error, lags)[lags:]
    squares = auto[1:] ** 2 / pairs
    quantile = float(stats.norm.ppf(0.5 + LEVEL / 2))
    whole = np.sqrt(spans)  # the inputs have no holes
    cross = {name: whole * correlation(error, inputs[:, k], lags) for k, name in enumerate(names)}
    bands = {name: whole * quantile * _spread(error, inputs[:, k], lags) for k, name in enumerate(names)}
    return ResidualTests(
        record=prediction.record,
        output=prediction.output_names[column],
        provenance=prediction.provenance,
        lags=dt * np.arange(lags + 1, dtype=float),
        autocorrelation=auto,
        band=quantile / np.sqrt(n),
        p_white=float(stats.chi2.sf(n * (n + 2) * squares.sum(), lags)),
        input_lags=dt * np.arange(-lags, lags + 1, dtype=float),
        cross_correlation=cross,
        input_bands=bands,
    )


def _with_holes(
    error: Array, rows: NDArray[np.int64], length: int, lags: int
) -> tuple[Array, NDArray[np.int64]]:
    """``error`` (n,) at the samples ``rows`` of ``length`` of a record, zero between them, and how many pairs
    of its samples are 1 to ``lags`` apart."""
    found, used = np.zeros(length), np.zeros(length, dtype=bool)
    found[rows], used[rows] = error, True
    pairs = np.array([np.sum(used[k:] & used[:-k]) for k in range(1, lags + 1)])
    return found, np.maximum(pairs, 1)


def correlation(later: Array, earlier: Array, lags: int) -> Array:
    """``corr(later(t + k), earlier(t))`` for k = -lags .. lags, shape (2 lags + 1,)."""
    a, b = later - later.mean(), earlier - earlier.mean()
    full = signal.correlate(a, b, mode="full", method="fft")
    size = np.sqrt(np.sum(a * a) * np.sum(b * b))
    middle = len(b) - 1
    return full[middle - lags : middle + lags + 1] / (size if size > 0 else 1.0)


def _spread(error: Array, u: Array, lags: int) -> float:
    """Standard deviation of the cross-correlation of independent series.

    ``1/n sum_k r_e(k) r_u(k)`` (Bartlett), which takes the autocorrelation of both into account.
    """
    reach = min(len(error) // 4, 20 * lags)
    products = correlation(error, error, reach) * correlation(u, u, reach)
    return float(np.sqrt(max(products.sum(), 1.0) / len(error)))
