"""A Kalman filter and smoother whose last state alone is disturbed, as a random walk.

    x+ = A x + b + (0, ..., 0, w),   y = C x + d + e,   w and e Gaussian and white

Source: Rauch, Tung, Striebel (1965), AIAA J. 3(8), 1445-1450; Särkkä (2013), Bayesian Filtering and
Smoothing, ch. 4 and 8.
"""

from __future__ import annotations

import numba
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
INITIAL_SPREAD = 10.0
"""Initial standard deviation of the states, in their scales: nothing is assumed."""


@numba.njit(cache=True)
def kalman_filter(
    a: Array, b: Array, c: Array, d: Array, y: Array, noise: Array, scales: Array, walk: float
) -> tuple[float, Array, Array, Array, Array]:
    """Kalman filter; the last state alone is disturbed, by variance ``walk`` a sample.

    Returns the log-likelihood, filtered means and covariances, and predicted ones. Loops, not matrix
    products: numba compiles them in a tenth of the time, and m is small.
    """
    n, m = b.shape
    mean, cov = np.zeros((n, m)), np.zeros((n, m, m))
    predicted, spread = np.zeros((n, m)), np.zeros((n, m, m))
    x, gain = np.zeros(m), np.zeros(m)
    p, half = np.zeros((m, m)), np.zeros((m, m))
    for i in range(m):
        p[i, i] = (INITIAL_SPREAD * scales[i]) ** 2
    total = 0.0
    for k in range(n):
        predicted[k], spread[k] = x, p
        for j in range(y.shape[1]):
            s, e = noise[j], y[k, j] - d[k, j]
            for i in range(m):
                gain[i] = 0.0
                for h in range(m):
                    gain[i] += p[i, h] * c[k, j, h]
                s += c[k, j, i] * gain[i]
                e -= c[k, j, i] * x[i]
            total -= 0.5 * (e * e / s + np.log(s))
            for i in range(m):
                x[i] += gain[i] * (e / s)
                for h in range(m):
                    p[i, h] -= gain[i] * gain[h] / s
        mean[k], cov[k] = x, p
        for i in range(m):
            x[i] = b[k, i]
            for h in range(m):
                x[i] += a[k, i, h] * mean[k, h]
        _congruent(a[k], cov[k], half, p)
        p[m - 1, m - 1] += walk
    return total, mean, cov, predicted, spread


def smooth(a: Array, mean: Array, cov: Array, predicted: Array, spread: Array) -> tuple[Array, Array]:
    """Rauch-Tung-Striebel smoother: smoothed states (n, m) and the last state's variance (n,)."""
    m = mean.shape[1]
    sizes = np.einsum("nii->ni", spread[1:])[:, :, None] * np.eye(m)
    ridge = 1e-13 * sizes + 1e-300 * np.eye(m)
    gains = np.linalg.solve(spread[1:] + ridge, a[:-1] @ cov[:-1]).swapaxes(1, 2)
    return _run_back(np.ascontiguousarray(gains), mean, cov, predicted, spread)


@numba.njit(cache=True)
def _run_back(gains: Array, mean: Array, cov: Array, predicted: Array, spread: Array) -> tuple[Array, Array]:
    """The smoother's recursion, from the last sample to the first."""
    n, m = mean.shape
    states, variance = mean.copy(), np.zeros(n)
    p, change, half = cov[n - 1].copy(), np.zeros((m, m)), np.zeros((m, m))
    variance[n - 1] = p[m - 1, m - 1]
    for k in range(n - 2, -1, -1):
        for i in range(m):
            for h in range(m):
                states[k, i] += gains[k, i, h] * (states[k + 1, h] - predicted[k + 1, h])
                change[i, h] = p[i, h] - spread[k + 1, i, h]
        _congruent(gains[k], change, half, p)
        for i in range(m):
            for h in range(m):
                p[i, h] += cov[k, i, h]
        variance[k] = p[m - 1, m - 1]
    return states, variance


@numba.njit(inline="always")
def _congruent(a: Array, p: Array, half: Array, found: Array) -> None:
    """``found = a p a'``, symmetric as p is; ``half`` holds a p."""
    m = len(p)
    for i in range(m):
        for j in range(m):
            half[i, j] = 0.0
            for h in range(m):
                half[i, j] += a[i, h] * p[h, j]
    for i in range(m):
        for j in range(i + 1):
            total = 0.0
            for h in range(m):
                total += half[i, h] * a[j, h]
            found[i, j] = found[j, i] = total
