"""The network's free run, sample by sample, and the gradient of its error, compiled.

This is one file, because numba's cache does not notice a change in another one. Every sum runs in one fixed
order on one thread, so the number of threads never changes a result.
"""

# mypy: disallow-untyped-defs=False, disallow-incomplete-defs=False
# (numba infers the types of the functions below: numbers, and arrays of float64)

from __future__ import annotations

from typing import Any

import numpy as np
from numba import float64, njit
from numba.extending import intrinsic

_SHIFT = 6755399441055744.0
"""1.5 * 2^52: a float64 of this size has no digits behind the point."""
_ONE = 1023 << 52
"""The bits of 1.0."""


def _fused(context, a, b, c):  # pragma: no cover
    return float64(float64, float64, float64), lambda _, builder, signature, given: builder.fma(*given)


_fma: Any = intrinsic(_fused)
"""``_fma(a, b, c)`` is ``a b + c``, rounded once: one instruction of today's processors, and the same bits on
every other."""


@njit
def _elu(x):  # pragma: no cover
    """``x`` above 0, ``exp(x) - 1`` below, to 2e-16 (absolute).

    Without a branch or a library's exponential: the compiler does several neurons at once, and every machine
    gets the same bits. ``exp(x) = 2^k exp(r)`` with the whole number k nearest to x / ln 2. To add
    ``_SHIFT`` leaves k in the last bits; ``<< 52`` makes them an exponent. The series of exp(r) - 1, |r| at
    most 0.35, ends where it is below the rounding; its parts do not wait for each other (Estrin's scheme).
    Below -40, exp is less than the rounding of 1.
    """
    below = x if x < 0.0 else 0.0
    y = below if below > -40.0 else -40.0
    shifted = _fma(y, 1.4426950408889634, _SHIFT)  # 1 / ln 2
    r = _fma(_SHIFT - shifted, 0.6931471805599453, y)
    scale = np.int64((np.float64(shifted).view(np.int64) << 52) + _ONE).view(np.float64)
    r2 = r * r
    r4 = r2 * r2
    a = _fma(r2, _fma(r, 1.0 / 24, 1.0 / 6), _fma(r, 0.5, 1.0))
    b = _fma(r2, _fma(r, 1.0 / 40320, 1.0 / 5040), _fma(r, 1.0 / 720, 1.0 / 120))
    c = _fma(r2, _fma(r, 1.0 / 479001600, 1.0 / 39916800), _fma(r, 1.0 / 3628800, 1.0 / 362880))
    e = r * _fma(r4, _fma(r4, c, b), a)
    return (x - below) + _fma(scale, e, scale - 1.0)


@njit
def _activate(sums):  # pragma: no cover
    for i in range(sums.shape[0]):
        sums[i] = _elu(sums[i])


@njit
def _slope(active):  # pragma: no cover
    """The ELU's derivative, told from its value."""
    return 1.0 if active > 0.0 else active + 1.0


@njit
def _add(sums, matrix, given):  # pragma: no cover
    """``sums += given @ matrix``, four rows at a time: the sums are read and written a quarter as often.

    For a few neurons it is faster than BLAS, whose every call costs.
    """
    whole = matrix.shape[0] // 4 * 4
    for k in range(0, whole, 4):
        a, b, c, d = given[k], given[k + 1], given[k + 2], given[k + 3]
        for i in range(matrix.shape[1]):
            one = _fma(matrix[k, i], a, matrix[k + 1, i] * b)
            sums[i] += one + _fma(matrix[k + 2, i], c, matrix[k + 3, i] * d)
    for k in range(whole, matrix.shape[0]):
        for i in range(matrix.shape[1]):
            sums[i] = _fma(matrix[k, i], given[k], sums[i])


@njit
def _remember(past, value):  # pragma: no cover
    for k in range(past.shape[0] - 1, 0, -1):
        past[k] = past[k - 1]
    if past.shape[0]:
        past[0] = value


@njit(cache=True, nogil=True)
def recur(first, by_past, hidden, biases, output, bias, past, carry, limit):  # pragma: no cover
    """``e(t) = carry e(t-1) + F``, each e fed back; returns (e, samples that stayed within ``limit``).

    ``first`` (m, width) is what the exogenous regressors and the bias give the first layer;
    ``by_past`` (n_e, width) its weights of the past errors ``past`` (n_e,), the newest first;
    ``hidden`` (depth - 1, width, width), from neuron to neuron, and ``biases`` (depth - 1, width) the other
    hidden layers; ``output`` (width,), ``bias`` the linear output. From where |e| > limit on, e is nan.
    """
    samples, width = first.shape
    found = np.full(samples, np.nan)
    past = past.copy()
    now, after = np.empty(width), np.empty(width)
    for t in range(samples):
        for i in range(width):
            now[i] = first[t, i]
        _add(now, by_past, past)
        _activate(now)
        for layer in range(hidden.shape[0]):
            for i in range(width):
                after[i] = biases[layer, i]
            _add(after, hidden[layer], now)
            _activate(after)
            now, after = after, now
        value = bias
        for i in range(width):
            value += output[i] * now[i]
        if past.shape[0]:
            value += carry * past[0]
        if not abs(value) <= limit:
            return found, t
        found[t] = value
        _remember(past, value)
    return found, samples


@njit
def _through(sums, now, hidden, biases, active, t):  # pragma: no cover
    """``now`` are the last layer's neurons, from the ``sums`` of the first; ``active[t]`` keeps those of
    all."""
    for layer in range(hidden.shape[0] + 1):
        for i in range(now.shape[0]):
            now[i] = _elu(sums[i])
        for i in range(now.shape[0]):
            active[t, layer, i] = now[i]
        if layer < hidden.shape[0]:
            for i in range(now.shape[0]):
                sums[i] = biases[layer, i]
            _add(sums, hidden[layer], now)


@njit(cache=True, nogil=True)
def simulate(layers, rows, runs, before, carry, limit, seen, active, found):  # pragma: no cover
    """Predict ``found`` (m,) over ``runs`` (r, 2), each from ``before`` (r, lags), the newest first.

    ``layers``: weights of past errors (lags, width) and of ``rows`` (m, d) (d, width), bias (width,); of the
    other hidden layers (depth - 1, width, width) and (depth - 1, width); of the output (width,) and (1,).
    Keeps what the gradient needs: past errors ``seen`` (m, lags) and neurons ``active`` (m, depth, width).
    False where |e| > limit.
    """
    by_past, by_rows, bias, hidden, biases, output, offset = layers
    width, lags = bias.shape[0], by_past.shape[0]
    sums, now, past = np.empty(width), np.empty(width), np.empty(lags)
    for r in range(runs.shape[0]):
        past[:] = before[r]
        for t in range(runs[r, 0], runs[r, 1]):
            seen[t] = past
            for i in range(width):
                sums[i] = bias[i]
            _add(sums, by_rows, rows[t])
            _add(sums, by_past, past)
            _through(sums, now, hidden, biases, active, t)
            value = offset[0] + (carry * past[0] if lags else 0.0)
            for i in range(width):
                value += output[i] * now[i]
            if not abs(value) <= limit:
                return False
            found[t] = value
            _remember(past, value)
    return True


@njit
def _outer(sums, given, delta):  # pragma: no cover
    """``sums += given delta'``."""
    for k in range(sums.shape[0]):
        one = given[k]
        for i in range(sums.shape[1]):
            sums[k, i] = _fma(one, delta[i], sums[k, i])


@njit
def _back(delta, below, turned, active, t, hidden, biases):  # pragma: no cover
    """From ``delta``, derivatives by the sums of the last layer's neurons, to those of the first."""
    for layer in range(hidden.shape[0] - 1, -1, -1):
        for k in range(delta.shape[0]):
            one = active[t, layer, k]
            for i in range(delta.shape[0]):
                hidden[layer, k, i] = _fma(one, delta[i], hidden[layer, k, i])
        for i in range(delta.shape[0]):
            biases[layer, i] += delta[i]
            below[i] = 0.0
        _add(below, turned[layer], delta)
        for i in range(delta.shape[0]):
            delta[i] = below[i] * _slope(active[t, layer, i])


@njit(cache=True, nogil=True)
def gradient(layers, turned, rows, runs, carry, seen, active, by_value, into):  # pragma: no cover
    """Add to ``into``, alike to ``layers``, the derivatives of a sum over all predictions.

    ``by_value`` (m,) are its derivatives by each prediction alone; it is overwritten by those through all
    later ones. ``turned`` are the weights of the past errors (width, lags) and of the hidden layers,
    transposed.
    """
    output = layers[5]
    by_past, by_rows, bias, hidden, biases, by_output, offset = into
    width, last, lags = output.shape[0], hidden.shape[0], seen.shape[1]
    delta, below, by_seen = np.empty(width), np.empty(width), np.empty(lags)
    for r in range(runs.shape[0]):
        begin = runs[r, 0]
        for t in range(runs[r, 1] - 1, begin - 1, -1):
            slope = by_value[t]
            offset[0] += slope
            for i in range(width):
                by_output[i] += slope * active[t, last, i]
                delta[i] = slope * output[i] * _slope(active[t, last, i])
            _back(delta, below, turned[1], active, t, hidden, biases)
            for i in range(width):
                bias[i] += delta[i]
            _outer(by_rows, rows[t], delta)
            _outer(by_past, seen[t], delta)
            by_seen[:] = 0.0
            _add(by_seen, turned[0], delta)
            for k in range(min(lags, t - begin)):
                by_value[t - 1 - k] += by_seen[k] + (carry * slope if k == 0 else 0.0)
