"""``Quality``: the verdict on a fit, frozen and typed; pages and the terminal only print it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from hybridid.advice import Advice
from hybridid.estimators.estimate import Estimate

Verdict = Literal["sound", "incomplete", "wrong", "not_converged"]
TRUSTED: tuple[Verdict, ...] = ("sound", "incomplete")
"""Verdicts with which standard errors are stated."""
Kind = Literal[
    "incomplete", "worse_than_nothing", "sign", "unit", "swapped", "bound", "step", "smoothing", "valley"
]
WRONG: frozenset[Kind] = frozenset(
    ("worse_than_nothing", "sign", "unit", "swapped", "bound", "step", "smoothing")
)
"""Findings with which no estimate is worth its standard error."""


@dataclass(frozen=True)
class Finding:
    """One thing that speaks against a fit, ``said`` in words.

    ``incomplete``: it leaves more than noise and simulation do, so physics is missing.
    ``worse_than_nothing``: a constant predicts better. ``sign``, ``unit``, ``swapped``, ``bound``: with a
    sign, a unit or two columns changed, or without the bounds of some parameters, the same model explains
    most of what it leaves. ``step``: the simulation's steps are too long for the motion that was fitted.
    ``smoothing``: the smoothing of sign(v) decides what was fitted. ``valley``: descents from several starts
    ended at different costs; the lowest is kept.
    """

    kind: Kind
    said: str


@dataclass(frozen=True)
class View:
    """What the model explains of one output of the fitted records together, in ``unit``.

    Over horizons of ``horizon`` s, each from its own initial state, or in free run (``horizon`` None):
    ``rmse`` is the RMS error, ``r2`` is 1 less its square over the output's variance, and ``nothing`` the RMS
    error of doing nothing: the mean of each record, or the value with which each horizon begins, whichever is
    less. Both are nan where the model diverges.
    """

    output: str
    unit: str
    horizon: float | None
    rmse: float
    r2: float
    nothing: float

    @property
    def worse_than_nothing(self) -> bool:
        """Whether doing nothing predicts as well."""
        return not self.rmse < self.nothing


@dataclass(frozen=True)
class Quality:
    """Whether a fit can be trusted.

    ``verdict`` is "sound" (nothing speaks against the model), "incomplete" (the estimates are those of this
    model, but it lacks physics), "wrong", or "not_converged". ``said`` is the verdict in words, ``findings``
    what speaks against the fit, ``views`` what the model explains. ``seconds`` is what judging took.
    ``advice`` says what to do, and changes no verdict.
    """

    verdict: Verdict
    said: str
    findings: tuple[Finding, ...]
    views: tuple[View, ...]
    seconds: float
    advice: tuple[Advice, ...] = ()

    @property
    def trusted(self) -> bool:
        """Whether the standard errors mean something."""
        return self.verdict in TRUSTED

    def withheld(self, estimate: Estimate) -> Estimate:
        """``estimate`` without its standard errors, unless they mean something: they are nan then."""
        return estimate if self.trusted else estimate.withheld()
