"""A network's error over stretches that it runs free, and the gradient of it, compiled.

This is one file, because numba's cache does not notice a change in another one. All sums run in one fixed
order on one thread, so the number of threads never changes a result.
"""

# mypy: disallow-untyped-defs=False, disallow-incomplete-defs=False
# (numba infers the types of the functions below: numbers, and arrays of float64)

from __future__ import annotations

import numpy as np
from numba import njit


@njit(inline="always")
def _add(sums, matrix, given):  # pragma: no cover
    """``sums += given @ matrix``."""
    for k in range(len(given)):
        for i in range(len(sums)):
            sums[i] += matrix[k, i] * given[k]


@njit(inline="always")
def _outer(sums, given, slopes):  # pragma: no cover
    """``sums += given slopes'``."""
    for k in range(len(given)):
        for i in range(len(slopes)):
            sums[k, i] += given[k] * slopes[i]


@njit(inline="always")
def _activate(active, sums):  # pragma: no cover
    """ELU: ``sums`` above 0, ``exp(sums) - 1`` below."""
    for i in range(len(sums)):
        active[i] = sums[i] if sums[i] > 0 else np.exp(sums[i]) - 1.0


@njit(inline="always")
def _slope(delta, active):  # pragma: no cover
    """``delta`` times the ELU's derivative, told from its value."""
    for i in range(len(active)):
        if active[i] <= 0:
            delta[i] *= active[i] + 1.0


@njit(inline="always")
def _remember(past, value):  # pragma: no cover
    for k in range(len(past) - 1, 0, -1):
        past[k] = past[k - 1]
    if len(past):
        past[0] = value


@njit(cache=True, nogil=True)
def simulate(layers, rows, runs, before, carry, limit, seen, active, found):  # pragma: no cover
    """Predict ``found`` (m,) over ``runs`` (r, 2), each from ``before`` (r, lags), the newest first.

    ``layers``: weights of past errors (lags, width) and of ``rows`` (m, d) (d, width), bias (width,); of the
    other hidden layers (depth - 1, width, width) and (depth - 1, width); of the output (width,) and (1,).
    Keeps what the gradient needs: past errors ``seen`` (m, lags) and neurons ``active`` (m, depth, width).
    False where |e| > limit.
    """
    by_past, by_rows, bias, hidden, biases, output, offset = layers
    sums, past = np.empty(len(bias)), np.empty(len(by_past))
    for r in range(len(runs)):
        past[:] = before[r]
        for t in range(runs[r, 0], runs[r, 1]):
            seen[t] = past
            sums[:] = bias
            _add(sums, by_rows, rows[t])
            _add(sums, by_past, past)
            _activate(active[t, 0], sums)
            for layer in range(len(hidden)):
                sums[:] = biases[layer]
                _add(sums, hidden[layer], active[t, layer])
                _activate(active[t, layer + 1], sums)
            value = offset[0]
            for i in range(len(output)):
                value += output[i] * active[t, -1, i]
            if len(past):
                value += carry * past[0]
            if not abs(value) <= limit:
                return False
            found[t] = value
            _remember(past, value)
    return True


@njit(cache=True, nogil=True)
def gradient(layers, turned, rows, runs, carry, seen, active, by_value, into):  # pragma: no cover
    """Add to ``into``, alike to ``layers``, the derivatives of a sum over all predictions.

    ``by_value`` (m,) are its derivatives by each prediction alone; it is overwritten by those through all
    later ones. ``turned`` are the weights of the past errors (width, lags) and of the hidden layers,
    transposed.
    """
    output = layers[5]
    past_turned, hidden_turned = turned
    by_past, by_rows, bias, hidden, biases, by_output, offset = into
    delta, below, by_seen = np.empty(len(output)), np.empty(len(output)), np.empty(seen.shape[1])
    for r in range(len(runs)):
        begin = runs[r, 0]
        for t in range(runs[r, 1] - 1, begin - 1, -1):
            slope = by_value[t]
            offset[0] += slope
            for i in range(len(output)):
                by_output[i] += slope * active[t, -1, i]
                delta[i] = slope * output[i]
            _slope(delta, active[t, -1])
            for layer in range(len(hidden) - 1, -1, -1):
                _outer(hidden[layer], active[t, layer], delta)
                for i in range(len(delta)):
                    biases[layer, i] += delta[i]
                below[:] = 0.0
                _add(below, hidden_turned[layer], delta)
                _slope(below, active[t, layer])
                delta[:] = below
            for i in range(len(delta)):
                bias[i] += delta[i]
            _outer(by_rows, rows[t], delta)
            _outer(by_past, seen[t], delta)
            by_seen[:] = 0.0
            _add(by_seen, past_turned, delta)
            for k in range(min(len(by_seen), t - begin)):
                by_value[t - 1 - k] += by_seen[k] + (carry * slope if k == 0 else 0.0)
