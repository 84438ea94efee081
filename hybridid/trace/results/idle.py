"""Declared effects of which the records show nothing.

An amplitude within two standard errors of zero is not told from zero. But two that are collinear, as the
viscous friction and the drag of one coast-down, may each be uncertain though together they are not. Of two
amplitudes of one effect, the effect acts. Of two effects, one acts, and the records do not say which. So
several amplitudes are only called zero if all of them together are not told from zero (Wald's test).

Source: Belsley, Kuh, Welsch (1980), Regression Diagnostics, ch. 3.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import combinations

import numpy as np
from scipy import stats

from hybridid.estimators import Estimate
from hybridid.model import Model, Term

SURE = 2.0
"""Standard errors within which an amplitude is not told from zero."""


def idle_terms(model: Model, estimate: Estimate) -> tuple[str, ...]:
    """The effects of the declared ``model`` of which the ``estimate`` shows nothing: their amplitudes are not
    told from zero, and neither are those of all of them together."""
    collinear = either_of(model, estimate)
    return tuple(name for name in _alone_near_zero(model, estimate) if name not in collinear)


def either_of(model: Model, estimate: Estimate) -> tuple[str, ...]:
    """The effects of the declared ``model`` of which each alone may be zero, but not all of them: what they
    do together is told from zero. Where two suffice for that, others are not among them."""
    found = _alone_near_zero(model, estimate)

    def told(names: Iterable[str]) -> bool:
        return _together_told(estimate, [each for name in names for each in found[name]])

    if len(found) < 2 or not told(found):
        return ()
    in_pairs = {name for pair in combinations(found, 2) if told(pair) for name in pair}
    return tuple(name for name in found if name in in_pairs or not in_pairs)


def _alone_near_zero(model: Model, estimate: Estimate) -> dict[str, list[str]]:
    """The effects of ``model`` that are not told from zero, with their amplitudes."""
    every = {term.name: amplitudes_of(term, model, estimate) for term in model.terms}
    return {term: own for term, own in every.items() if own and not told_from_zero(estimate, own)}


def amplitudes_of(term: Term, model: Model, estimate: Estimate) -> list[str]:
    """The amplitudes of ``term`` in ``estimate`` by name: one for each group of records that has its own."""
    estimated = {p.name for p in estimate.parameters}
    nesting = [f"{term.name}.{p.name}" for p in term.effect.parameters if p.nests]
    return [each for name in nesting for each in model.names_of(name) if each in estimated]


def told_from_zero(estimate: Estimate, names: Sequence[str]) -> bool:
    """Whether ``estimate`` tells the amplitudes called ``names`` from zero: one of them stands off it by more
    than ``SURE`` standard errors, or all of them together do as surely. One without a standard error counts
    as told: nothing says that it may be zero."""
    own = {p.name: p for p in estimate.parameters}
    near = all(abs(own[name].value) <= SURE * own[name].std for name in names)
    return not near or _together_told(estimate, names)


def _together_told(estimate: Estimate, names: Sequence[str]) -> bool:
    """Whether the parameters called ``names`` together stand off zero as surely as one beyond ``SURE``."""
    every = [p.name for p in estimate.parameters]
    places = [every.index(name) for name in names]
    value = np.array([estimate.parameters[k].value for k in places])
    std = np.array([estimate.parameters[k].std for k in places])
    covariance = estimate.correlation[np.ix_(places, places)] * np.outer(std, std)
    if not np.isfinite(covariance).all():
        return False
    squared = float(value @ np.linalg.pinv(covariance) @ value)
    return bool(stats.chi2.sf(squared, len(places)) < stats.chi2.sf(SURE**2, 1))
