"""Where a search should have taken another effect in an earlier step.

A forward search takes the best effect of each step. Where two effects are missing, one that resembles their
sum may be better than each of them: an eddy-current brake, whose force falls with the speed, in the place of
Coulomb and Stribeck friction. It then stays, and all that follows is judged beside it. So before another step
begins, each earlier effect is exchanged for every other one that passed in its step and took at least half as
much (``Rules.majority``), beside each member of the class that was accepted last. If one of these models
leaves less than the last one by what an effect must take (``Rules.worth``), significantly with all of them
counted, the search goes back to that step and takes the other effect. That one may be refused there alone:
beside a declared law that is wrong, its amplitude differs from record to record. Then both effects of the
better model are judged as a pair (``hybridid.trace.trials.pair``). If the pair fails too, the search does not
go back: nothing has shown that any other effect of that step leads further.

Source: sequential replacement; Miller (2002), Subset Selection in Regression, 2nd ed., Chapman & Hall, ch. 3.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass, replace

from hybridid.trace.context import Context
from hybridid.trace.horizons.evidence import compare
from hybridid.trace.horizons.split import Split
from hybridid.trace.refits.refit import FAILURES, LEAST_DECREASE, refit_beside, refit_if_possible
from hybridid.trace.refits.refitted import Refit
from hybridid.trace.rules import Rules
from hybridid.trace.search.pair_decision import pair_taken
from hybridid.trace.search.steps import Step
from hybridid.trace.trials.cross_fitting import pairs_cross_fitted
from hybridid.trace.trials.pair import attempt_pair, judge_pairs, values_of
from hybridid.trace.trials.promise import Promise, overlap
from hybridid.trace.trials.trial import PASSED, REJECTED, Trial


@dataclass(frozen=True)
class Exchange:
    """``rival`` in the place of what the step ``number`` took, beside ``member`` of the class accepted last;
    ``refit`` is None where that model cannot be simulated."""

    number: int
    rival: Trial
    member: Trial
    refit: Refit | None

    def __str__(self) -> str:
        return f"{self.rival.candidate.name} + {self.member.candidate.name}"


def better_branch(
    steps: Sequence[Step], last: Refit, gone_back: Collection[int], context: Context
) -> Exchange | None:
    """The best exchange that explains more than the model ``last`` of ``steps``; None if none does. Steps
    whose number is among ``gone_back`` stay as they are."""
    newest = steps[-1].accepted if len(steps) > 1 else None
    if newest is None or newest.name not in _terms(last):
        return None
    given = [
        (number, rival, member, (earlier, newest.name), last, context.split)
        for number, earlier, rival in _rivals(steps, last, context.rules)
        if number not in gone_back
        for member in newest.alike
        if member.candidate.name != rival.candidate.name
    ]
    tried = context.each("in the place of an earlier effect", _exchanged, given, str)
    solved = [(one, one.refit) for one in tried if one.refit is not None]
    if not solved:
        return None
    best, refitted = min(solved, key=lambda pair: pair[1].score.loss)
    advantage = compare(last.score, refitted.score)
    return best if context.rules.passes(advantage.gain, len(given) * advantage.p_value) else None


def without_the_better(step: Step, exchange: Exchange) -> tuple[Trial, ...]:
    """The trials of ``step``, those refused that took more there than the effect that explains more later."""
    why = (
        f"beside {exchange.member.candidate.name}, found later, {exchange.rival.candidate.name} explains more"
    )
    return tuple(
        replace(t, status=REJECTED, reason=why) if t.status == PASSED and t.gain > exchange.rival.gain else t
        for t in step.trials
    )


def both_taken(step: Step, exchange: Exchange, context: Context) -> Step:
    """``step`` with both effects of ``exchange`` taken as a pair, if that passes; else with nothing taken."""
    one, other = exchange.rival.candidate, exchange.member.candidate
    fitted, base, rules = exchange.refit, step.base, context.rules
    if not context.pairs or fitted is None or overlap(one, other):
        return replace(step, accepted=None)
    alone = {t.candidate.name: t for t in step.trials}
    shared = {name: fitted.values.get(name, value) for name, value in base.values.items()}
    starts = {**shared, **values_of(fitted, one)}, values_of(fitted, other)
    singles = alone.get(one.name), alone.get(other.name)
    least = min([base.cost, *(single.refit.cost for single in singles if single and single.refit)])
    promise = Promise(one, other, starts, 1.0 - fitted.cost / least)
    candidates = len(context.candidates(base.model))
    family = candidates * (candidates - 1) // 2
    pair = context.one(attempt_pair, promise, singles, base, context.split, rules)
    judged = pairs_cross_fitted(judge_pairs([pair], family, rules), base, family, context)
    return pair_taken(replace(step, accepted=None, family=family), judged, context)


def _rivals(steps: Sequence[Step], last: Refit, rules: Rules) -> Iterator[tuple[int, str, Trial]]:
    """The number of each step but the last, the effect that it took, if that is still there, and each other
    effect that had passed there and took a good part of that. What was removed, and taken again by a later
    step, is there by that one."""
    present = _terms(last)
    for number, step in enumerate(steps[:-1]):
        one = step.accepted
        again = {later.name for after in steps[number + 1 :] for later in after.taken}
        if one is None or step.together or one.name not in present - again:
            continue
        for trial in step.trials:
            rivals = (
                trial.status == PASSED and trial.refit is not None and trial.candidate.name not in present
            )
            if rivals and trial.taken >= rules.majority * one.trial.taken:
                yield number, one.name, trial


def _exchanged(
    number: int, rival: Trial, member: Trial, names: tuple[str, str], last: Refit, split: Split
) -> Exchange:
    """``member`` beside ``rival``, both in the place of the effects ``names`` of the model ``last``: to the
    end if that promises to explain more. It begins where it ended in its own step, too: what it seeks was
    found there."""
    beside = _in_place(rival, names, last, split)
    return Exchange(number, rival, member, None if beside is None else _beside(beside, member, last, split))


def _beside(beside: Refit, member: Trial, last: Refit, split: Split) -> Refit | None:
    """The model ``beside`` with ``member``; None if it cannot be simulated."""
    assert member.refit is not None
    candidate, numerics = member.candidate, member.refit.numerics
    model = candidate.added_to(beside.model)
    starts = candidate.starts(model, beside.values)
    own = values_of(member.refit, candidate)
    try:
        return refit_beside(
            beside, model, split, [{**starts[0], **own}, *starts], numerics, last, LEAST_DECREASE
        )
    except (ValueError, *FAILURES):
        return None


def _in_place(rival: Trial, names: tuple[str, str], last: Refit, split: Split) -> Refit | None:
    """The model ``last`` with ``rival`` alone in the place of the effects ``names``; None if it cannot be
    simulated."""
    assert rival.refit is not None
    model = last.model
    for name in names:
        model = model.without(name)
    model = rival.candidate.added_to(model)
    if model == rival.refit.model:
        return rival.refit
    kept = {p.name for p in model.parameters}
    start = {key: value for key, value in {**last.values, **rival.refit.values}.items() if key in kept}
    return refit_if_possible(model, split, [start], last, last.numerics)


def _terms(fitted: Refit) -> set[str]:
    return {term.name for term in fitted.model.terms}
