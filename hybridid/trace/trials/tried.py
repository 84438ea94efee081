"""All trials of a step, the quickest first; under a time limit the most promising ones of these.

A trial takes seconds to minutes, the promise of an effect (``hybridid.trace.trials.promise``) a few
simulations. It only orders the trials. What is left out is told. What has taken most so far is reported with
each result, so a trace that is interrupted has told it.

Where several parameters change together and the cost hardly does, a refit goes on along that valley
(``hybridid.trace.starts.valley``), by up to two dozen more refits. That serves only a trial that its step may
choose, so the best trial is known first. A law that explains no more than one that it contains is that one,
and has no valley of its own to go along.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

from hybridid.trace.candidates import Candidate
from hybridid.trace.context import Context
from hybridid.trace.refits.refit import least_of
from hybridid.trace.refits.refitted import Refit
from hybridid.trace.starts.valley import has_valley
from hybridid.trace.trials.contained import begun_from_contained, is_the_contained_one
from hybridid.trace.trials.promise import promised_alone
from hybridid.trace.trials.sensitivity import seen
from hybridid.trace.trials.trial import Trial, attempt, gone_on

ALWAYS = 5
"""Effects that are tried in any time: without a trial there is no answer."""
LEAST_TOLD = 0.01
"""Share of the held-out error from which on what an effect takes is told at once."""
NEAR = 2.0
"""Times the held-out error of the best trial up to which another goes on along its valley. Along a valley the
cost changes little, so what leaves far more error than the best trial will not be chosen."""


def trials_of(base: Refit, context: Context, stage: str) -> tuple[list[Trial], tuple[str, ...]]:
    """A trial of every candidate beside ``base``, and the names of those that the time limit left out."""
    candidates = context.candidates(base.model)
    if math.isinf(context.until):
        given = _given(candidates, base, context)
        trials = context.each(stage, attempt, given, MostSoFar(), lambda one, *_: -one.inner_states)
        return _from_other_starts(trials, base, context, stage), ()
    ordered = _most_promising_first(candidates, base, context)
    trials = context.each(stage, attempt, _given(ordered, base, context), MostSoFar(), always=ALWAYS)
    trials = _from_other_starts(trials, base, context, stage)
    left_out = {one.name for one in ordered[len(trials) :]}
    by_name = {one.candidate.name: one for one in trials}
    as_listed = [by_name[one.name] for one in candidates if one.name in by_name]
    return as_listed, tuple(one.name for one in candidates if one.name in left_out)


def tried_in_place(
    name: str, rivals: Sequence[Candidate], base: Refit, richer: Refit, context: Context
) -> list[Trial]:
    """A trial of each of ``rivals`` in the place of the effect ``name``, which ``base`` lacks and ``richer``
    has."""
    stage = f"in place of {name}"
    given = [(*one, None, richer) for one in _given(rivals, base, context)]
    return _from_other_starts(context.each(stage, attempt, given, _name), base, context, stage)


def _from_other_starts(trials: Sequence[Trial], base: Refit, context: Context, stage: str) -> list[Trial]:
    """``trials`` beside ``base``, begun from what they contain, and gone on along their valleys."""
    return along_valleys(begun_from_contained(trials, base, context, stage), base, context, stage)


def along_valleys(trials: Sequence[Trial], base: Refit, context: Context, stage: str) -> list[Trial]:
    """``trials`` beside ``base``; those that may be chosen have gone on along their valleys, while there is
    time."""
    losses = [trial.refit.score.loss if trial.refit else math.inf for trial in trials]
    most = min(NEAR * min(losses, default=math.inf), (1 - least_of(context.rules.worth)) * base.score.loss)
    near = [
        k
        for k, (trial, loss) in enumerate(zip(trials, losses, strict=True))
        if trial.refit and loss <= most and has_valley(trial.refit, trial.candidate)
        if not is_the_contained_one(trial, trials)
    ]
    given = [(trials[k], base, context.split) for k in near]
    gone = context.each(f"{stage}, along valleys", gone_on, given, _name, always=0)
    found = dict(zip(near, gone, strict=False))  # a time limit may leave out the last ones
    return [found.get(k, trial) for k, trial in enumerate(trials)]


def _given(
    candidates: Sequence[Candidate], base: Refit, context: Context
) -> list[tuple[Candidate, Refit, object, float]]:
    return [(candidate, base, context.split, context.rules.worth) for candidate in candidates]


def _name(trial: Trial) -> str:
    return trial.candidate.name


class MostSoFar:
    """Labels the trials of a step in turn: by name, with the one that takes most of the held-out error of
    those labelled so far. None of them is judged yet."""

    def __init__(self) -> None:
        self._most = ""
        self._gain = LEAST_TOLD

    def __call__(self, trial: Trial) -> str:
        if trial.gain > self._gain:
            self._gain = trial.gain
            self._most = f", most so far {trial.candidate.name}: {trial.gain:.1%} off the held-out error"
        return f"{trial.candidate.name}{self._most}"


def _most_promising_first(candidates: Sequence[Candidate], base: Refit, context: Context) -> list[Candidate]:
    """Those without inner states come first: their trials take a fraction of the time. What no time was left
    to rank promises nothing."""
    quick_first = sorted(candidates, key=lambda one: one.inner_states)
    given = [(one, None, base, context.split, True) for one in quick_first]
    shown = context.each("effects, ranked", seen, given, lambda one: one.candidate.name, always=0)
    promises = [promised_alone(one) for one in shown] + [0.0] * (len(given) - len(shown))
    order = sorted(range(len(given)), key=lambda k: (quick_first[k].inner_states, -promises[k]))
    return [quick_first[k] for k in order]
