"""How stationary noise drives the estimates of a fit, from one horizon into the next."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.signal import lfilter

from hybridid.estimators.absorbed import Absorbed
from hybridid.estimators.noise import Autoregression, noise_of
from hybridid.simulation.windows import in_parts, within

Array = NDArray[np.float64]
NOTHING = 1e-17
"""Share of a sum that is rounding."""


def of_noise(fitted: Absorbed, origin: tuple[tuple[int, int, int], ...]) -> Array:
    """``Q' Sigma Q`` (n, n) for stationary noise, which runs on from one horizon to the next.

    Sigma is built from what passes through the autoregressions, begun a record's length before
    the record; outputs whose innovations are correlated share it.
    """
    n = fitted.parameters.shape[3]
    noises = noise_of(fitted)
    middle, innovations = np.zeros((n, n)), []
    runs = list(_runs(fitted, origin))
    for _, residual in runs:
        innovations.append([lfilter(ar.taps, [1.0], e) for ar, e in zip(noises, residual.T, strict=True)])
    alike = _correlation(np.concatenate(innovations, axis=1))
    for basis, _ in runs:
        middle += _driven(noises, basis, alike)
    return middle


def _runs(fitted: Absorbed, origin: tuple[tuple[int, int, int], ...]) -> Iterator[tuple[Array, Array]]:
    """Basis (N, n_y, n) and residual (N, n_y) of the horizons that follow each other without a gap.

    Both are zero at masked samples: noise there drives no estimate, but is as old as it is.
    """
    begin, inside = 0, within(fitted.used)
    for k in range(1, len(origin) + 1):
        if k < len(origin) and origin[k][:2] == (origin[k - 1][0], origin[k - 1][2]):
            continue
        run = slice(begin, k)
        yield fitted.parameters[run][inside[run]], fitted.residual[run][inside[run]]
        begin = k


def _driven(noises: Sequence[Autoregression], basis: Array, alike: Array) -> Array:
    """``B' Sigma B`` (n, n) of one run: what the innovations of the ``noises``, whose correlation is
    ``alike`` (n_y, n_y), drive of the directions of the basis (N, n_y, n). They are taken latest first, a
    part at a time, until what those before the record still drive is rounding."""
    count, n = len(basis), basis.shape[2]
    memory = [np.zeros((n, ar.order)) for ar in noises]
    found = np.zeros((n, n))
    for part in in_parts(2 * count, 1):
        latest = np.zeros((part.stop - part.start, *basis.shape[1:]))
        own = basis[::-1][part]
        latest[: len(own)] = own
        through = []
        for k, ar in enumerate(noises):
            driven, memory[k] = lfilter([1.0], ar.taps, latest[:, k].T, zi=memory[k])
            through.append(np.sqrt(ar.variance) * driven)
        more = sum(alike[k, m] * a @ b.T for k, a in enumerate(through) for m, b in enumerate(through))
        found += more
        if part.start >= count and np.trace(more) <= NOTHING * np.trace(found):
            break
    return found


def _correlation(innovations: Array) -> Array:
    """Correlation (n_y, n_y) of series (n_y, N); one that is all zero is like no other."""
    products = innovations @ innovations.T
    size = np.sqrt(np.diag(products))
    size[size == 0] = 1.0
    alike = products / np.outer(size, size)
    np.fill_diagonal(alike, 1.0)
    return alike
