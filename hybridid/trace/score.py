"""``Score``: what held-out horizons say of a model, horizon by horizon."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.signal import lfilter

from hybridid.estimators.noise import autoregression, most_lags

Array = NDArray[np.float64]
BLOCKS = 48
"""Where there are fewer horizons, each is divided: with so many units Student's t is near its limit."""
SHORTEST = 8
"""Samples of a block at least."""
MEDIAN = 0.6745
"""Median size of a Gaussian variable, in standard deviations."""


@dataclass(frozen=True)
class Score:
    """Held-out evidence.

    By horizon, (h, n_y): ``squares`` sums of squared errors in units², ``samples`` how many. By block,
    (b, n_y), one or several a horizon: ``likelihood``, the Gaussian log-likelihood of the errors whitened by
    an autoregression that was fitted to the model's own residual on the fitted horizons.
    By output, (n_y,): ``scale`` is the standard deviation over the records, ``innovation`` that of the
    whitened held-out errors, from the median of their sizes: a few large ones do not raise it.
    """

    squares: Array
    samples: Array
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


def score_of(fitted: Sequence[Array], held_out: Sequence[Array], scale: Array, blocks: int = BLOCKS) -> Score:
    """The score from each horizon's errors (n_k, n_y), fitted and held out; ``scale`` (n_y,).

    The likelihood is that of at least ``blocks`` blocks, if there are samples enough.
    """
    n_y = held_out[0].shape[1]
    whitened = [_whitened([e[:, k] for e in fitted], [e[:, k] for e in held_out]) for k in range(n_y)]
    return Score(
        squares=np.array([(e**2).sum(axis=0) for e in held_out]),
        samples=np.array([[len(e)] * n_y for e in held_out]),
        likelihood=np.stack([_likelihood(*one, blocks) for one in whitened], axis=1),
        scale=scale,
        innovation=np.array([_level(innovations) for innovations, _ in whitened]),
    )


def _whitened(fitted: Sequence[Array], held_out: Sequence[Array]) -> tuple[list[Array], float]:
    """The innovations of each held-out row under the fitted residual's autoregression, and their variance.

    Of every row the first samples are conditioned on, as many whatever the order: a likelihood of
    more samples is no better or worse a likelihood.
    """
    coefficients, variance = autoregression(fitted)
    taps = np.concatenate([[1.0], -coefficients])
    first = most_lags([len(row) for row in fitted])
    return [lfilter(taps, [1.0], row)[min(first, len(row) // 2) :] for row in held_out], variance


def _likelihood(innovations: Sequence[Array], variance: float, least: int) -> Array:
    """Gaussian log-likelihood of each block of the ``innovations``, of this ``variance``.

    Innovations are independent from sample to sample, if the autoregression holds. So a few long horizons are
    divided into blocks: what their samples tell is not lost in the few degrees of freedom of so few horizons.
    """
    blocks = [block for row in innovations for block in _divided(row, -(-least // len(innovations)))]
    if variance <= 0:
        return np.full(len(blocks), np.inf)
    return np.array([-0.5 * np.sum(e**2 / variance + np.log(2 * np.pi * variance)) for e in blocks])


def _level(innovations: Sequence[Array]) -> float:
    """Standard deviation of Gaussian ``innovations``, by the median of their sizes."""
    return float(np.median(np.abs(np.concatenate(innovations))) / MEDIAN)


def _divided(row: Array, parts: int) -> list[Array]:
    """``row`` in at most so many ``parts``, none shorter than ``SHORTEST``."""
    return np.array_split(row, max(1, min(parts, len(row) // SHORTEST)))
