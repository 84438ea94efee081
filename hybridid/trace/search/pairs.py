"""Pairs of effects, where the search stalled: two that help only together.

Coulomb friction and quadratic drag may each gain little or nothing beside a viscous friction that was
declared in the place of both, so a search that adds one effect at a time stops before either. So after a
stall, all pairs of effects are ranked by what they promise together (``hybridid.trace.trials.promise``). The
most promising ones are refitted and judged (``hybridid.trace.trials.pair``), with all pairs that could be
formed counted; not those that promise less than a refit must show to go on. Every effect can be a member,
also one that was refused or withdrawn alone.

An effect that resembles a pair may have been accepted in its place, and further effects to fit the rest. So
where effects were accepted and something is still left, pairs are also tried beside the declared model. One
that alone explains more than all accepted effects together, by more than ``Rules.tie`` and significantly,
takes their place. (Sequential replacement: Miller (2002), Subset Selection in Regression, 2nd ed., ch. 3.)
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

from hybridid.naming import counted, listed
from hybridid.trace.context import Context
from hybridid.trace.horizons.evidence import compare
from hybridid.trace.refits.refit import least_of
from hybridid.trace.rules import Rules
from hybridid.trace.search.pair_decision import pair_taken
from hybridid.trace.search.search import without_needless
from hybridid.trace.search.steps import Search, Step, said_of
from hybridid.trace.trials.cross_fitting import pairs_cross_fitted
from hybridid.trace.trials.pair import PairTrial, attempt_pair, judge_pairs
from hybridid.trace.trials.promise import Promise, most_promising, promises
from hybridid.trace.trials.sensitivity import seen
from hybridid.trace.trials.trial import PASSED, REJECTED

TOLD = 5
"""Effects that are in no pair and are told by name, at most."""


def with_pair(found: Search, context: Context, accepted_before: Search | None = None) -> Search:
    """``found`` with the best pair of effects that passes, and in its last step the pairs that were tried.

    It is ``found`` itself if it did not end with a stall, or no pair can be formed. The pair must explain
    more than the last model of ``accepted_before``, whose pairs count as well.
    """
    step, rules = found.steps[-1] if found.steps else None, context.rules
    room = len(found.accepted) + 2 <= rules.most_effects
    if step is None or step.taken or step.pairs or not (context.pairs and room):
        return found
    candidates = context.candidates(step.base.model)
    singles = {trial.candidate.name: trial for trial in step.trials}
    given = [(one, singles.get(one.name), step.base, context.split) for one in candidates]
    shown = context.each("pairs, ranked", seen, given, lambda one: one.candidate.name)
    unseen = [one.candidate.name for one in shown if not one.shapes]
    if unseen:
        names = listed(unseen) if len(unseen) <= TOLD else counted(len(unseen), "effect")
        context.say(f"left out of all pairs, as the residual does not show what they would change: {names}")
    free = context.most_free - len(step.base.model.free)
    promised = [one for one in promises(shown, rules.collinear) if one.free_parameters <= free]
    ranked = most_promising(promised, 1.0 - (1.0 - rules.worth) ** 2)
    if not ranked:
        return found
    hopeful = [one for one in ranked[: context.pairs] if one.share >= least_of(rules.worth)]
    chosen = [
        (
            one,
            tuple(singles.get(c.name) for c in (one.first, one.second)),
            step.base,
            context.split,
            rules,
        )
        for one in hopeful
    ]
    family = len(candidates) * (len(candidates) - 1) // 2
    if accepted_before is None:
        trials = context.each("pairs", attempt_pair, chosen, _name, _inner_states, always=0)
        judged = pairs_cross_fitted(judge_pairs(trials, family, rules), step.base, family, context)
    else:
        family += accepted_before.steps[-1].family
        trials, judged = _judged_in_place(chosen, accepted_before, family, context)
    step = pair_taken(replace(step, family=family), judged, context)
    context.say(
        f"of {counted(family, 'pair')}, {len(trials)} tried: {said_of(step) if step.taken else 'none passes'}"
    )
    return _taken(found, step, context)


def _name(trial: PairTrial) -> str:
    return trial.name


def _inner_states(promise: Promise, *_: object) -> int:
    return promise.inner_states


def in_place(found: Search, context: Context) -> Search:
    """The pair that explains more than all accepted effects of ``found``, in their place; ``found`` itself if
    there is none."""
    if not found.accepted:
        return found
    names = listed([one.name for one in found.accepted])
    context.say(f"pairs in place of {names}")
    tried = with_pair(found.before_any, context, found)
    return tried if tried.accepted else found


def _judged_in_place(
    chosen: Sequence[tuple[Any, ...]], before: Search, family: int, context: Context
) -> tuple[list[PairTrial], list[PairTrial]]:
    """The pairs tried, and as judged, in the place of what the search ``before`` accepted.

    A refit ends early where it promises too little over the last model of ``before``. If a pair passes, all
    are tried again without that: another one may be as good.
    """
    for rival in (before.final, None):
        given = [(*one, rival) for one in chosen]
        trials = context.each("pairs", attempt_pair, given, _name, _inner_states, always=0)
        judged = [
            _unless_better(pair, before, family, context.rules)
            for pair in judge_pairs(trials, family, context.rules)
        ]
        if not any(pair.status == PASSED for pair in judged):
            break
    return trials, judged


def _unless_better(pair: PairTrial, before: Search, family: int, rules: Rules) -> PairTrial:
    """``pair``, refused if it does not explain more than the last model of ``before``."""
    if pair.status != PASSED or pair.refit is None:
        return pair
    better = compare(before.final.score, pair.refit.score)
    if better.gain >= rules.tie and family * better.p_value <= rules.alpha:
        return pair
    names = listed([one.name for one in before.accepted])
    return replace(pair, status=REJECTED, reason=f"explains no more than {names}, found one by one")


def _taken(found: Search, step: Step, context: Context) -> Search:
    """``found`` with ``step`` in the place of its last, and with what was taken in it."""
    earlier, new = found.steps[:-1], step.taken
    if not new or new[0].trial.refit is None:
        return replace(found, steps=(*earlier, step))
    final, accepted, dropped = without_needless(
        new[0].trial.refit, [*found.accepted, *new], context, new=len(new)
    )
    return replace(
        found,
        steps=(*earlier, replace(step, dropped=dropped)),
        final=final,
        accepted=tuple(accepted),
        withdrawn="",
    )
