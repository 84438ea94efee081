"""Whether the values that a parameter takes in groups of records differ by more than their errors.

With v (k,) the estimates of the groups, C (k, k) their covariance and D (k - 1, k) the differences from the
first, ``chi2 = (D v)' (D C D')^-1 (D v)``. Were all values one, it would be chi-square distributed with k - 1
degrees of freedom. What moves all estimates alike (the smoothing of sign(v), a parameter that they share)
drops out of the differences. Source: Rao (1973), Linear Statistical Inference and its Applications, sec. 4b.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.special import chdtrc

from hybridid.declarations import Parameter
from hybridid.estimators.estimate import Difference
from hybridid.model import Model

Array = NDArray[np.float64]


def differences(
    model: Model, free: Sequence[str], values: Mapping[str, float], covariance: Array
) -> tuple[Difference, ...]:
    """One for each parameter with groups of which at least two are among the ``free``; ``covariance`` (n, n)
    is theirs."""
    declared = {p.name: p for p in model.parameters}
    found = []
    for name, groups in model.groups.items():
        chosen = [(g, one) for g, one in zip(groups, model.names_of(name), strict=True) if one in free]
        if len(chosen) > 1:
            rows = [free.index(one) for _, one in chosen]
            v = np.array([values[one] for _, one in chosen])
            numbers = (v, covariance[np.ix_(rows, rows)])
            found.append(_difference(name, declared[chosen[0][1]], tuple(g for g, _ in chosen), *numbers))
    return tuple(found)


def _difference(
    name: str, declared: Parameter, groups: tuple[str, ...], v: Array, covariance: Array
) -> Difference:
    statistic = chi_square(v, covariance)
    degrees = len(v) - 1
    return Difference(
        parameter=name,
        unit=declared.unit,
        groups=groups,
        mean=float(v.mean()),
        lowest=float(v.min()),
        highest=float(v.max()),
        spread=float(v.std(ddof=1)),
        chi_square=statistic,
        degrees=degrees,
        p_value=float(chdtrc(degrees, statistic)) if math.isfinite(statistic) else math.nan,
    )


def chi_square(v: Array, covariance: Array) -> float:
    """``(D v)' (D C D')^-1 (D v)`` of the values ``v`` (k,); nan where the covariance (k, k) says nothing."""
    if not np.isfinite(covariance).all():
        return math.nan
    d = np.hstack([-np.ones((len(v) - 1, 1)), np.eye(len(v) - 1)])
    apart, doubt = d @ v, d @ covariance @ d.T
    size = np.sqrt(np.diag(doubt))
    if not (size > 0).all():
        return math.nan
    return float(
        (apart / size) @ np.linalg.pinv(doubt / np.outer(size, size), hermitian=True) @ (apart / size)
    )
