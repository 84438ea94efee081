"""Declared effects of which the records show nothing.

An amplitude within two standard errors of zero is not told from zero. But two that are collinear, as the
viscous friction and the drag of one coast-down, may each be uncertain though together they are not. Of two
amplitudes of one effect, the effect acts. Of two effects, one acts, and the records do not say which. So
several amplitudes are only called zero if all of them together are not told from zero (Wald's test).

Source: Belsley, Kuh, Welsch (1980), Regression Diagnostics, ch. 3.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy import stats

from hybridid.estimators import Estimate
from hybridid.model import Model, Term

SURE = 2.0
"""Standard errors within which an amplitude is not told from zero."""


def idle_terms(model: Model, estimate: Estimate) -> tuple[str, ...]:
    """The effects of the declared ``model`` of which the ``estimate`` shows nothing: their amplitudes are not
    told from zero, and neither are those of all of them together."""
    every = {term.name: amplitudes_of(term, model, estimate) for term in model.terms}
    found = {term: own for term, own in every.items() if own and not told_from_zero(estimate, own)}
    several = [name for own in found.values() for name in own]
    return () if len(found) > 1 and _together_told(estimate, several) else tuple(found)


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
