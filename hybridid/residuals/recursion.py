"""The network's free run, one sample after the other, compiled.

All in one file, because numba's cache does not notice a change in another one.
"""

# mypy: disallow-untyped-defs=False, disallow-incomplete-defs=False
# (numba infers the types of the functions below: numbers, and arrays of float64)

from __future__ import annotations

import numpy as np
from numba import njit


@njit(cache=True, nogil=True)
def recur(first, by_past, hidden, biases, output, bias, past, carry, limit):  # pragma: no cover
    """``e(t) = carry e(t-1) + F``, each e fed back; returns (e, samples that stayed within ``limit``).

    ``first`` (m, width) is what the exogenous regressors and the bias give the first layer;
    ``by_past`` (width, n_e) its weights of the past errors ``past`` (n_e,), the newest first;
    ``hidden`` (depth - 1, width, width), ``biases`` (depth - 1, width) the other hidden layers;
    ``output`` (width,), ``bias`` the linear output. From where |e| > limit on, e is nan.
    """
    samples, width = first.shape
    lags = past.shape[0]
    found = np.full(samples, np.nan)
    past = past.copy()
    active, following = np.empty(width), np.empty(width)
    for t in range(samples):
        for i in range(width):
            value = first[t, i]
            for k in range(lags):
                value += by_past[i, k] * past[k]
            active[i] = value if value > 0 else np.expm1(value)
        for layer in range(hidden.shape[0]):
            np.dot(hidden[layer], active, following)
            for i in range(width):
                value = following[i] + biases[layer, i]
                active[i] = value if value > 0 else np.expm1(value)
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
