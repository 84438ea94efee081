"""Whether the values that a parameter takes in groups of records differ by more than their errors.

With v (k,) the estimates of the groups, C (k, k) their covariance and D (k - 1, k) the differences from the
first, ``chi2 = (D v)' (D C D')^-1 (D v)``. Were all values one, it would be chi-square distributed with k - 1
degrees of freedom. What moves all estimates alike (the smoothing of sign(v), a parameter that they share)
drops out of the differences. Of parameters that are nearly collinear each may seem to be one value where
they differ together: D then has a block for each.

Source: Rao (1973), Linear Statistical Inference and its Applications, sec. 4b.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import block_diag
from scipy.special import chdtrc

from hybridid.estimators.estimate import AllOne, Difference
from hybridid.model import Model

Array = NDArray[np.float64]


def differences(
    model: Model, free: Sequence[str], values: Mapping[str, float], covariance: Array
) -> tuple[tuple[Difference, ...], AllOne | None]:
    """One for each parameter with groups of which at least two are among the ``free``, and of several
    parameters the test of all together; ``covariance`` (n, n) is that of the free."""
    units = {p.name: p.unit for p in model.parameters}
    each, rows = [], []
    for name, groups in model.groups.items():
        chosen = {g: one for g, one in zip(groups, model.names_of(name), strict=True) if one in free}
        if len(chosen) > 1:
            own = [free.index(one) for one in chosen.values()]
            v = np.array([values[one] for one in chosen.values()])
            test = chi_square_test([v], covariance[np.ix_(own, own)])
            each.append(_difference(name, units[free[own[0]]], tuple(chosen), v, test))
            rows.append(own)
    if len(each) < 2:
        return tuple(each), None
    every = [row for own in rows for row in own]
    numbers = [np.array([values[free[row]] for row in own]) for own in rows]
    return tuple(each), chi_square_test(numbers, covariance[np.ix_(every, every)])


def _difference(name: str, unit: str, groups: tuple[str, ...], v: Array, test: AllOne) -> Difference:
    return Difference(
        parameter=name,
        unit=unit,
        groups=groups,
        mean=float(v.mean()),
        lowest=float(v.min()),
        highest=float(v.max()),
        spread=float(v.std(ddof=1)),
        test=test,
    )


def chi_square_test(values: Sequence[Array], covariance: Array) -> AllOne:
    """The test that each parameter has one value, from ``values``, (k,) each, and the covariance of all."""
    statistic, degrees = chi_square(values, covariance), sum(len(v) - 1 for v in values)
    p_value = float(chdtrc(degrees, statistic)) if math.isfinite(statistic) else math.nan
    return AllOne(statistic, degrees, p_value)


def chi_square(values: Sequence[Array], covariance: Array) -> float:
    """``(D v)' (D C D')^-1 (D v)`` of the values of each parameter, (k,) each; nan where the covariance of
    all (n, n) says nothing."""
    if not np.isfinite(covariance).all():
        return math.nan
    d = block_diag(*(np.hstack([-np.ones((len(v) - 1, 1)), np.eye(len(v) - 1)]) for v in values))
    apart, doubt = d @ np.concatenate(values), d @ covariance @ d.T
    size = np.sqrt(np.diag(doubt))
    if not (size > 0).all():
        return math.nan
    inverse = np.linalg.pinv(doubt / np.outer(size, size), hermitian=True)
    return float((apart / size) @ inverse @ (apart / size))
