"""The network's free run, sample by sample, compiled.

This is one file, because numba's cache does not notice a change in another one.
"""

# mypy: disallow-untyped-defs=False, disallow-incomplete-defs=False
# (numba infers the types of the functions below: numbers, and arrays of float64)

from __future__ import annotations

import numpy as np
from numba import njit


@njit(inline="always")
def _add(sums, weights, given):  # pragma: no cover
    """``sums += given @ weights``: for a few neurons twice as fast as BLAS, whose every call costs."""
    for k in range(len(given)):
        for i in range(len(sums)):
            sums[i] += weights[k, i] * given[k]


@njit(inline="always")
def _elu(active, sums):  # pragma: no cover
    """``active = sums`` above 0, ``exp(sums) - 1`` below."""
    for i in range(len(sums)):
        active[i] = sums[i] if sums[i] > 0 else np.exp(sums[i]) - 1.0


@njit(cache=True, nogil=True)
def recur(first, by_past, hidden, biases, output, bias, past, carry, limit):  # pragma: no cover
    """``e(t) = carry e(t-1) + F``, each e fed back; returns (e, samples that stayed within ``limit``).

    ``first`` (m, width) is what the exogenous regressors and the bias give the first layer;
    ``by_past`` (n_e, width) its weights of the past errors ``past`` (n_e,), the newest first;
    ``hidden`` (depth - 1, width, width), from neuron to neuron, and ``biases`` (depth - 1, width) the other
    hidden layers; ``output`` (width,), ``bias`` the linear output. From where |e| > limit on, e is nan.
    """
    samples, width = first.shape
    lags = past.shape[0]
    found = np.full(samples, np.nan)
    past = past.copy()
    active, sums = np.empty(width), np.empty(width)
    for t in range(samples):
        sums[:] = first[t]
        _add(sums, by_past, past)
        _elu(active, sums)
        for layer in range(hidden.shape[0]):
            sums[:] = biases[layer]
            _add(sums, hidden[layer], active)
            _elu(active, sums)
        value = bias + np.dot(output, active)
        if lags:
            value += carry * past[0]
        if not abs(value) <= limit:
            return found, t
        found[t] = value
        for k in range(lags - 1, 0, -1):
            past[k] = past[k - 1]
        if lags:
            past[0] = value
    return found, samples
