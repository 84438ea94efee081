"""Declared effects of which the records show nothing.

An amplitude within two standard errors of zero is not told from zero. But two effects that are collinear, as
the viscous friction and the drag of one coast-down, may each be uncertain though together they are not: one
of them acts, and the records do not say which. So several are called idle only if all their amplitudes
together are not told from zero (Wald's test).

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
    """The effects of the declared ``model`` of which the ``estimate`` shows nothing: each amplitude is within
    ``SURE`` standard errors of zero, and so are those of all of them together."""
    places = {p.name: k for k, p in enumerate(estimate.parameters)}

    def amplitudes(term: Term) -> list[int]:
        nesting = [f"{term.name}.{p.name}" for p in term.effect.parameters if p.nests]
        names = [each for name in nesting for each in model.names_of(name)]
        return [places[name] for name in names if name in places]

    def idle(term: Term) -> bool:
        own = [estimate.parameters[k] for k in amplitudes(term)]
        return bool(own) and all(abs(p.value) <= SURE * p.std for p in own)

    found = [term for term in model.terms if idle(term)]
    if len(found) > 1 and _together_no_zero(estimate, [k for term in found for k in amplitudes(term)]):
        return ()
    return tuple(term.name for term in found)


def _together_no_zero(estimate: Estimate, places: Sequence[int]) -> bool:
    """Whether the parameters at ``places`` together are told from zero, as surely as one beyond ``SURE``."""
    value = np.array([estimate.parameters[k].value for k in places])
    std = np.array([estimate.parameters[k].std for k in places])
    covariance = estimate.correlation[np.ix_(places, places)] * np.outer(std, std)
    if not np.isfinite(covariance).all():
        return False
    squared = float(value @ np.linalg.pinv(covariance) @ value)
    return bool(stats.chi2.sf(squared, len(places)) < stats.chi2.sf(SURE**2, 1))
