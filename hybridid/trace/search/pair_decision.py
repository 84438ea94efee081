"""Which of the pairs that were tried is accepted, if one is, and what these records cannot tell from it.

A pair that passes must survive other numerics, each member beside the other. Then every candidate is tried in
the place of each member, beside the other one: those that do as well form its class, as in a forward step. A
pair is refused where another one without a common member, and physically unrelated, explains as much; then no
other is accepted either.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import replace

from hybridid.trace.context import Context
from hybridid.trace.horizons.evidence import compare
from hybridid.trace.rules import Rules
from hybridid.trace.search.steps import Accepted, Step
from hybridid.trace.trials.alike import equivalents, related
from hybridid.trace.trials.judgement import judge
from hybridid.trace.trials.pair import PairTrial
from hybridid.trace.trials.robustness import objection, survivals_of
from hybridid.trace.trials.trial import PASSED, REJECTED, UNIDENTIFIABLE, Trial
from hybridid.trace.trials.tried import tried_in_place


def pair_taken(
    step: Step, judged: Sequence[PairTrial], context: Context, among: Collection[str] | None = None
) -> Step:
    """``step`` with the best of the ``judged`` pairs that passes and survives other numerics, if one does.
    Only effects whose ids are ``among`` these (None: all) may be in its classes."""
    rules, judged = context.rules, list(judged)
    while passed := [pair for pair in judged if pair.status == PASSED]:
        best = _preferred(passed, rules)
        survivals = [
            survivals_of(poorer, member, context, {})
            for poorer, member in zip(best.alone, best.members, strict=True)
        ]
        lost = "; ".join(filter(None, map(objection, survivals)))
        strangers = "" if lost else _strangers(step, best, judged, rules)
        if not lost and not strangers:
            classes = [_class_of(best, k, judged, step.family, context, among) for k in range(2)]
            first, second = (
                Accepted(member, alike, kept, together=other.candidate.name)
                for member, other, alike, kept in zip(
                    best.members, best.members[::-1], classes, survivals, strict=True
                )
            )
            return replace(step, pairs=tuple(judged), accepted=first, together=second, minor="")
        withdrawn = replace(best, status=REJECTED, reason=f"withdrawn: {lost or strangers}")
        judged = [withdrawn if pair is best else pair for pair in judged]
        if strangers:  # whatever explains less is no better a name
            break
    return replace(step, pairs=tuple(judged))


def _preferred(passed: Sequence[PairTrial], rules: Rules) -> PairTrial:
    """The best held-out error; among those alike, the one with the fewest parameters."""
    best = max(passed, key=lambda pair: pair.gain)
    alike = [best, *(pair for pair in passed if pair is not best and _as_good(best, pair, rules))]
    return min(alike, key=lambda pair: (_free_parameters(pair), -pair.gain))


def _free_parameters(pair: PairTrial) -> int:
    return sum(one.free_parameters for one in pair.candidates)


def _as_good(best: PairTrial, other: PairTrial, rules: Rules) -> bool:
    """Whether held-out horizons show no relevant advantage of ``best``."""
    assert best.refit is not None
    assert other.refit is not None
    advantage = compare(other.refit.score, best.refit.score)
    return advantage.gain < rules.tie or advantage.p_value > rules.alpha


def _equals(step: Step, best: PairTrial, judged: Sequence[PairTrial], rules: Rules) -> list[PairTrial]:
    """The other pairs that held-out horizons cannot tell from ``best``.

    One that only significance refused counts if it takes at least half as much: see ``alike.equivalents``.
    """
    before = step.base.score.loss**2

    def takes(pair: PairTrial) -> float:
        return before - pair.refit.score.loss**2 if pair.refit else 0.0

    def counts(pair: PairTrial) -> bool:
        enough = bool(pair.members) and all(member.gain >= rules.worth for member in pair.members)
        return enough and pair.status != UNIDENTIFIABLE and 2 * takes(pair) >= takes(best)

    return [pair for pair in judged if pair is not best and counts(pair) and _as_good(best, pair, rules)]


def _strangers(step: Step, best: PairTrial, judged: Sequence[PairTrial], rules: Rules) -> str:
    """Which pair without a common member explains as much and is physically unrelated; empty if none."""
    for pair in _equals(step, best, judged, rules):
        if not _common(best, pair) and _matched(best, pair) is None:
            return f"these records cannot tell it from {pair.name}, physically unrelated to it"
    return ""


def _common(one: PairTrial, other: PairTrial) -> bool:
    return not {c.name for c in one.candidates}.isdisjoint(c.name for c in other.candidates)


def _matched(best: PairTrial, pair: PairTrial) -> tuple[Trial, Trial] | None:
    """The members of ``pair`` in the order of those of ``best`` to which they are related, if they are."""
    first, second = pair.members
    for order in ((first, second), (second, first)):
        if all(related(ours, theirs) for ours, theirs in zip(best.members, order, strict=True)):
            return order
    return None


def _class_of(
    best: PairTrial,
    k: int,
    judged: Sequence[PairTrial],
    family: int,
    context: Context,
    among: Collection[str] | None,
) -> tuple[Trial, ...]:
    """The trials that held-out horizons cannot tell from member ``k`` of ``best``, itself first.

    Every candidate takes its place beside the other member.
    """
    member, poorer, rules = best.members[k], best.alone[k], context.rules
    name = member.candidate.name
    others = [one for one in context.candidates(poorer.model) if one.name != name]
    rivals = [one for one in others if among is None or one.effect.id in among]
    assert best.refit is not None
    trials = tried_in_place(name, rivals, poorer, best.refit, context)
    at_noise = context.meets_noise(best.refit.score)
    alike = equivalents(member, judge(trials, rules, family), rules, at_noise)
    for pair in judged:
        matched = (
            None if pair is best or pair.status != PASSED or _common(best, pair) else _matched(best, pair)
        )
        if matched is not None and _as_good(best, pair, rules):
            alike.append(matched[k])
    return tuple(alike)
