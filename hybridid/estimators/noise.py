"""The noise behind a residual, of which the fit has already taken its share.

A fit with residual Jacobian J turns noise e into the residual ``r = Q e``, ``Q = I - B B'``,
with B (N, k) orthonormal over the columns of J: parameters, and the initial states of every
horizon. Slow noise is taken most, so the autocovariance of r is too small just where slow
parameters look. Each output's noise is an autoregression whose *residual* would have the
autocovariance that is seen: ``E[r r'] = Q Sigma Q``, solved by a fixed point. Source: Worsley
et al. (2002), NeuroImage 15(1), 1-15, sec. 2.5; Schwarz (1978), Annals of Statistics 6(2).
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy import fft
from scipy.signal import lfilter, lfiltic

from hybridid.estimators.absorbed import Absorbed, Basis
from hybridid.simulation.windows import in_parts

Array = NDArray[np.float64]
MOST_LAGS = 50
"""Longest autoregression tried; its order minimises the Bayesian information criterion."""
ROUNDS = 12
SETTLING = 5
"""Rounds of the fixed point during which the order may still change."""
CLOSE = 0.01
"""Relative change of the parameters' variances at which the fixed point has arrived."""
NEAREST_ROOT = 0.99999
"""Largest partial autocorrelation: a root on the unit circle has no autocovariance."""
HALVINGS = 12


class Autoregression(NamedTuple):
    """``e(t) = sum_k coefficients[k] e(t - 1 - k) + innovation``, of variance ``variance``."""

    coefficients: Array
    variance: float

    @property
    def order(self) -> int:
        """Number of past errors that it uses."""
        return len(self.coefficients)

    @property
    def taps(self) -> Array:
        """The filter from e to its innovation."""
        return np.concatenate([[1.0], -self.coefficients])


def noise_of(fitted: Absorbed) -> list[Autoregression]:
    """The noise of each output, its outputs taken as independent of each other."""
    size = fft.next_fast_len(2 * fitted.used.shape[1], real=True)
    lags = most_lags(fitted.lengths)
    seen = _autocovariance(fitted, size, lags)
    basis = Basis.of(fitted, size, lags)
    weights, targets = None, list(seen)
    for attempt in range(ROUNDS):
        noises = [_chosen(t, float(n)) for t, n in zip(targets, fitted.samples, strict=True)]
        kernels = [_extended(t, noise, basis.length) for t, noise in zip(targets, noises, strict=True)]
        through = basis.through(kernels)
        spread = basis.variances(through)
        if weights is not None and np.allclose(spread, weights, rtol=CLOSE, atol=0):
            break
        weights, expected = spread, basis.expected(kernels, through)
        targets = [
            _moved(kernel[: (lags if attempt < SETTLING else noise.order) + 1], now - then, noise.order)
            for kernel, noise, now, then in zip(kernels, noises, seen, expected, strict=True)
        ]
    return noises


def autoregression(pieces: Sequence[Array]) -> tuple[Array, float]:
    """Autoregression of a series in pieces: coefficients (order,) and innovation variance.

    Yule-Walker on the pooled autocovariance, always stable; the order minimises BIC.
    """
    lengths = [len(piece) for piece in pieces]
    lags, total = most_lags(lengths), max(sum(lengths), 1)
    products = [sum(float(p[k:] @ p[: len(p) - k]) for p in pieces if len(p) > k) for k in range(lags + 1)]
    return _chosen(np.array(products) / total, total)


def most_lags(lengths: Sequence[int] | NDArray[np.int64]) -> int:
    """The highest order of an autoregression of a series in pieces of these ``lengths``."""
    return max(0, min(MOST_LAGS, int(max(lengths)) // 4, int(sum(lengths)) // 20))


def _autocovariance(fitted: Absorbed, size: int, lags: int) -> Array:
    """Products of the residual at up to ``lags`` samples' distance, a sample's share, (n_y, lags + 1)."""
    parts = in_parts(*fitted.used.shape)
    power = sum((np.abs(fft.rfft(fitted.residual[k], size, axis=1)) ** 2).sum(axis=0) for k in parts)
    return fft.irfft(power, size, axis=0)[: lags + 1].T / fitted.samples[:, None]


def _levinson(covariance: Array) -> list[Autoregression]:
    """Autoregressions of order 0, 1, ... as far as ``covariance`` is positive definite."""
    a, variance = np.zeros(0), float(covariance[0])
    found = [Autoregression(a, variance)]
    for m in range(1, len(covariance)):
        if variance <= 0:
            break
        partial = (covariance[m] - a @ covariance[m - 1 : 0 : -1]) / variance
        if not abs(partial) <= NEAREST_ROOT:
            break
        a = np.append(a - partial * a[::-1], partial)
        variance *= 1 - partial**2
        found.append(Autoregression(a, float(variance)))
    return found


def _chosen(covariance: Array, samples: float) -> Autoregression:
    """The autoregression of lowest BIC for an autocovariance (lags + 1,)."""
    if covariance[0] <= 0:
        return Autoregression(np.zeros(0), 0.0)
    found = _levinson(covariance)
    least = np.finfo(float).tiny
    scores = [samples * np.log(max(ar.variance, least)) + ar.order * np.log(samples) for ar in found]
    return found[int(np.argmin(scores))]


def _extended(covariance: Array, noise: Autoregression, length: int) -> Array:
    """Autocovariance (length,) of ``noise``, whose first lags are those it was made from."""
    order = noise.order
    known = covariance[: order + 1]
    if order == 0 or length <= order + 1:
        return np.pad(known, (0, max(length - len(known), 0)))[:length]
    memory = lfiltic([1.0], noise.taps, known[:0:-1])
    rest, _ = lfilter([1.0], noise.taps, np.zeros(length - order - 1), zi=memory)
    return np.concatenate([known, rest])


def _moved(covariance: Array, change: Array, order: int) -> Array:
    """``covariance`` plus as much of ``change`` as leaves it positive definite up to ``order``."""
    share = 1.0
    for _ in range(HALVINGS):
        moved = covariance + share * change[: len(covariance)]
        if len(_levinson(moved)) > order:
            return moved
        share /= 2
    return covariance
