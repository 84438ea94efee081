"""All trials of a step; under a time limit the quickest and most promising ones first.

A trial takes seconds to minutes, the promise of an effect (``hybridid.trace.promise``) a few simulations. It
only orders the trials. What is left out is told.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

from hybridid.trace.candidates import Candidate, admissible
from hybridid.trace.context import Context
from hybridid.trace.promise import promised_alone
from hybridid.trace.refit import Refit
from hybridid.trace.sensitivity import seen
from hybridid.trace.trial import Trial, attempt

ALWAYS = 5
"""Effects that are tried in any time: without a trial there is no answer."""


def trials_of(base: Refit, context: Context, stage: str) -> tuple[list[Trial], tuple[str, ...]]:
    """A trial of every candidate beside ``base``, and the names of those that the time limit left out."""
    candidates = list(admissible(base.model, context.effects, context.ports))
    if math.isinf(context.until):
        given = _given(candidates, base, context)
        return context.each(stage, attempt, given, _name, lambda candidate, *_: candidate.inner_states), ()
    ordered = _most_promising_first(candidates, base, context)
    trials = context.each(stage, attempt, _given(ordered, base, context), _name, always=ALWAYS)
    left_out = {one.name for one in ordered[len(trials) :]}
    by_name = {one.candidate.name: one for one in trials}
    as_listed = [by_name[one.name] for one in candidates if one.name in by_name]
    return as_listed, tuple(one.name for one in candidates if one.name in left_out)


def _given(
    candidates: Sequence[Candidate], base: Refit, context: Context
) -> list[tuple[Candidate, Refit, object, float]]:
    return [(candidate, base, context.split, context.rules.worth) for candidate in candidates]


def _name(trial: Trial) -> str:
    return trial.candidate.name


def _most_promising_first(candidates: Sequence[Candidate], base: Refit, context: Context) -> list[Candidate]:
    """Those without inner states come first: their trials take a fraction of the time."""
    given = [(one, None, base, context.split, True) for one in candidates]
    shown = context.each("effects, ranked", seen, given, lambda one: one.candidate.name)
    order = sorted(shown, key=lambda one: (one.candidate.inner_states, -promised_alone(one)))
    return [one.candidate for one in order]
