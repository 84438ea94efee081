"""Effects whose law contains that of another: the richer one explains at least as much.

Bouc-Wen's hysteresis contains Dahl's friction, a load behind a play one behind a spring. So where the fit of
the richer effect leaves more than that of the poorer one, it has ended in a wrong valley, and begins once
more where the poorer one ended. Else a resonance would be named where the records show the play before it.

An effect contains another one of its kind if it has all of its parameters and is declared to look like it.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

from hybridid.trace.context import Context
from hybridid.trace.refits.refit import LEAST_DECREASE, least_of
from hybridid.trace.refits.refitted import Refit
from hybridid.trace.trials.alike import look_alikes
from hybridid.trace.trials.trial import Trial, begun_from


def begun_from_contained(trials: Sequence[Trial], base: Refit, context: Context, stage: str) -> list[Trial]:
    """``trials`` beside ``base``; each that leaves more than one whose law it contains has begun there, too.

    Only where the poorer one takes enough from the held-out error to be chosen.
    """
    worth = context.rules.worth
    most = (1 - least_of(worth)) * base.score.loss
    poorer = {k: one for k, trial in enumerate(trials) if (one := _better_contained(trial, trials, most))}
    given = [(trials[k], one, base, context.split, worth) for k, one in poorer.items()]
    again = context.each(
        f"{stage}, from what they contain", begun_from, given, lambda t: t.candidate.name, always=0
    )
    found = dict(zip(poorer, again, strict=False))  # a time limit may leave out the last ones
    return [found.get(k, trial) for k, trial in enumerate(trials)]


def _better_contained(trial: Trial, trials: Sequence[Trial], most: float) -> Refit | None:
    """Of the ``trials`` whose law that of ``trial`` contains, the refit with the lowest cost, if that is
    lower and its held-out loss at most ``most``; else None."""
    cost = trial.refit.cost if trial.refit else math.inf
    better = [one for one in _contained(trial, trials) if one.cost < cost and one.score.loss <= most]
    return min(better, key=lambda one: one.cost, default=None)


def is_the_contained_one(trial: Trial, trials: Sequence[Trial]) -> bool:
    """Whether ``trial`` explains no more of the fitted horizons than one of ``trials`` whose law it contains,
    up to what is worth a refit."""
    assert trial.refit is not None
    enough = trial.refit.cost / (1 - LEAST_DECREASE)
    return any(one.cost < enough for one in _contained(trial, trials))


def _contained(trial: Trial, trials: Sequence[Trial]) -> list[Refit]:
    """The refits of those of ``trials`` whose law that of ``trial`` contains."""
    return [other.refit for other in trials if other.refit and contains(trial, other)]


def contains(richer: Trial, poorer: Trial) -> bool:
    """Whether the law of one effect contains that of the other, at the same port."""
    if richer.candidate.port != poorer.candidate.port or not look_alikes(richer, poorer):
        return False
    ours, theirs = (
        {p.name for p in one.candidate.effect.parameters if not p.fixed} for one in (richer, poorer)
    )
    return theirs < ours
