"""``Score``: what held-out horizons say of a model, horizon by horizon."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.signal import lfilter

from hybridid.estimators.noise import autoregression, most_lags

Array = NDArray[np.float64]
Cells = NDArray[np.bool_]
BLOCKS = 48
"""Where there are fewer horizons, each is divided: with so many units Student's t is near its limit."""
SHORTEST = 8
"""Samples of a block at least."""
MEDIAN = 0.6745
"""Median size of a Gaussian variable, in standard deviations."""


@dataclass(frozen=True)
class Score:
    """Held-out evidence.

    By horizon, (h, n_y): ``squares`` sums of squared errors in units², ``samples`` how many: those at which
    the output was measured. By block, (b, n_y), one or several a horizon: ``block_squares`` and
    ``block_samples`` the same, and ``likelihood``, the Gaussian log-likelihood of the errors whitened by an
    autoregression that was fitted to the model's own residual on the fitted horizons.
    By output, (n_y,): ``scale`` is the standard deviation over the records, ``innovation`` that of the
    whitened held-out errors, from the median of their sizes: a few large ones do not raise it.
    """

    squares: Array
    samples: Array
    block_squares: Array
    block_samples: Array
    likelihood: Array
    scale: Array
    innovation: Array

    @property
    def rmse(self) -> Array:
        """Root mean square error of each output, (n_y,), in the output's unit."""
        return np.sqrt(self.squares.sum(axis=0) / self.samples.sum(axis=0))

    @property
    def loss(self) -> float:
        """One number for all outputs: RMSE of the errors over their output's scale."""
        return float(np.sqrt(np.mean((self.rmse / self.scale) ** 2)))


def score_of(
    fitted: Sequence[Array],
    held_out: Sequence[Array],
    scale: Array,
    blocks: int = BLOCKS,
    cells: tuple[Sequence[Cells], Sequence[Cells]] | None = None,
) -> Score:
    """The score from each horizon's errors (n_k, n_y), fitted and held out; ``scale`` (n_y,).

    ``cells`` (n_k, n_y), fitted and held out, say which errors count (None: all). The others must be zero.
    The likelihood is that of at least ``blocks`` blocks, if there are samples enough.
    """
    ours, theirs = cells or ([np.ones_like(e, dtype=bool) for e in part] for part in (fitted, held_out))
    rows = [_measured(held_out, theirs, k) for k in range(len(scale))]
    whitened = [_whitened(_measured(fitted, ours, k), row) for k, row in enumerate(rows)]
    parts = _parts([innovations for innovations, _ in whitened], blocks)
    return Score(
        squares=np.array([(e**2).sum(axis=0) for e in held_out]),
        samples=np.array([one.sum(axis=0) for one in theirs]),
        block_squares=_by_block(rows, parts, lambda e: float(e @ e)),
        block_samples=_by_block(rows, parts, len),
        likelihood=np.stack([_of_blocks(*one, parts) for one in whitened], axis=1),
        scale=scale,
        innovation=np.array([_level(innovations) for innovations, _ in whitened]),
    )


def _measured(errors: Sequence[Array], cells: Sequence[Cells], k: int) -> list[Array]:
    """The errors of output ``k`` in each horizon, (m_k,): the two sides of a gap are joined."""
    return [e[:, k] if c[:, k].all() else e[c[:, k], k] for e, c in zip(errors, cells, strict=True)]


def _parts(rows: Sequence[Sequence[Array]], least: int) -> list[int]:
    """Into how many blocks each horizon is divided, ``least`` altogether, from ``rows`` of each output: a
    horizon has as many in each output.

    What the samples of a few long horizons tell is not lost in the few degrees of freedom of so few.
    """
    most = -(-least // len(rows[0]))
    shortest = [min(map(len, outputs)) for outputs in zip(*rows, strict=True)]
    return [max(1, min(most, length // SHORTEST)) for length in shortest]


def _by_block(rows: Sequence[Sequence[Array]], parts: Sequence[int], of: Callable[[Array], float]) -> Array:
    """``of`` each block of each output's ``rows``, (b, n_y)."""
    return np.array([[of(block) for block in _divided(each, parts)] for each in rows]).T


def _divided(rows: Sequence[Array], parts: Sequence[int]) -> list[Array]:
    """Each of ``rows`` in so many ``parts``."""
    return [block for row, n in zip(rows, parts, strict=True) for block in np.array_split(row, n)]


def _whitened(fitted: Sequence[Array], held_out: Sequence[Array]) -> tuple[list[Array], float]:
    """Innovations of each held-out row under the fitted residual's autoregression, and their variance.

    Innovations are independent from sample to sample, if the autoregression holds.

    Of every row the first samples are conditioned on, as many whatever the order: a likelihood of
    more samples is no better or worse a likelihood.
    """
    coefficients, variance = autoregression(fitted)
    taps = np.concatenate([[1.0], -coefficients])
    first = most_lags([len(row) for row in fitted])
    measured = [lfilter(taps, [1.0], row) if len(row) else row for row in held_out]
    return [row[min(first, len(row) // 2) :] for row in measured], variance


def _level(innovations: Sequence[Array]) -> float:
    """Standard deviation of Gaussian ``innovations``, by the median of their sizes."""
    return float(np.median(np.abs(np.concatenate(innovations))) / MEDIAN)


def _of_blocks(innovations: Sequence[Array], variance: float, parts: Sequence[int]) -> Array:
    """Gaussian log-likelihood of each block, (b,): each row of ``innovations`` in so many ``parts``."""
    if variance <= 0:
        return np.full(sum(parts), np.inf)
    blocks = _divided(innovations, parts)
    return np.array([-0.5 * np.sum(e**2 / variance + np.log(2 * np.pi * variance)) for e in blocks])
