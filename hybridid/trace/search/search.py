"""The search: forward steps by refitting every admissible effect, with a backward check."""

from __future__ import annotations

import math
import time
from collections.abc import Mapping, Sequence
from dataclasses import replace

from hybridid.model import Model
from hybridid.trace.context import Context
from hybridid.trace.horizons.evidence import compare
from hybridid.trace.learned.ceiling import ceilings
from hybridid.trace.learned.minor import MINOR, may_be_minor, minor_beside, said_of_minor
from hybridid.trace.refits.numerics import DECLARED, Numerics
from hybridid.trace.refits.refit import CONTINUATION, refit, refit_if_possible
from hybridid.trace.refits.refitted import Refit, values_without
from hybridid.trace.rules import Rules
from hybridid.trace.search.backtrack import better_branch, both_taken, without_the_better
from hybridid.trace.search.class_lead import led_by_the_better
from hybridid.trace.search.finer_steps import in_short_steps
from hybridid.trace.search.many_steps import many_steps
from hybridid.trace.search.sharper import explains_more_wider, sharp_enough, sharper_for_an_effect
from hybridid.trace.search.steps import (
    NONE_PASSES,
    OUT_OF_TIME,
    RECORDINGS_DIFFER,
    Accepted,
    Back,
    Search,
    Step,
    back_at,
    said_of,
)
from hybridid.trace.search.stops import nothing_to_seek, out_of_time, two_mixed_classes
from hybridid.trace.search.unequal import each_with_its_own
from hybridid.trace.starts.shorter import beside_shorter
from hybridid.trace.starts.solve import declared_refit
from hybridid.trace.trials.alike import equivalents, indistinguishable
from hybridid.trace.trials.constancy import fitted_to_held_out, moved
from hybridid.trace.trials.cross_fitting import cross_fitted
from hybridid.trace.trials.exchange import exchanged
from hybridid.trace.trials.judgement import judge
from hybridid.trace.trials.robustness import Otherwise, objection, survivals_of
from hybridid.trace.trials.smoothed_apart import rivals_smoothed_apart
from hybridid.trace.trials.trial import PASSED, REJECTED, Trial
from hybridid.trace.trials.tried import trials_of


def search(
    model: Model,
    context: Context,
    start: Sequence[Mapping[str, float]],
    numerics: Numerics = DECLARED,
) -> Search:
    """Add effects to ``model`` until none passes or the residual is no more than the sensors' noise.

    ``start`` holds parameter values to start the declared model from.
    """
    base = declared_refit(model, context, start, numerics)
    if told := many_steps(base, context.split):
        context.say(told)
    base = beside_shorter(base, context)
    found = continued(Search((), base, (), ""), context, anew=True)
    nothing = found.stopped == NONE_PASSES and not found.accepted
    if found.stopped == RECORDINGS_DIFFER or (context.own_values and nothing):
        return replace(found.before_any, stopped=RECORDINGS_DIFFER)
    return found


def continued(found: Search, context: Context, anew: bool = False) -> Search:
    """Add effects to the last model of ``found``, as ``search`` does.

    Where a narrower smoothing of sign(v) pays only beside what was accepted, that was judged by a simulation
    too coarse for this machine. If another effect of its step now explains more in its place, the search
    begins ``anew`` from the declared model, with the narrower smoothing, if time is left for as much again.
    """
    base, first_began = found.final, time.monotonic()
    steps, accepted, took = list(found.steps), list(found.accepted), 0.0
    wider: Step | None = None
    gone_back: set[int] = set()
    while True:
        began = time.monotonic()
        before = in_short_steps(base, context)
        sharp = sharp_enough(before, context, declared=not accepted)
        again = anew and sharp is not before and context.has_time_for(time.monotonic() - first_began)
        if again and (better := _outdone(sharp, steps, context)):
            return _begun_anew(replace(found, steps=tuple(steps)), sharp, better, context)
        base = sharp
        stopped = nothing_to_seek(base, accepted, context)
        begun = base
        base = begun if stopped or context.out_of_time else beside_shorter(begun, context)
        if base.cost < begun.cost:
            continue
        stopped = stopped or out_of_time(steps, took, context)
        if back := _gone_back(steps, base, context, gone_back, stopped):
            steps, base, accepted = back
            continue
        if stopped:
            return replace(found, steps=tuple(steps), final=base, accepted=tuple(accepted), stopped=stopped)
        step = _step_as_smooth(base, context, len(steps) + 1, None if sharp is before else before)
        context.say(f"step {len(steps) + 1}: {said_of(step)}")
        if step.accepted is None or step.accepted.trial.refit is None:
            if wider is not None:
                context.say("with the narrower smoothing no effect is accepted, so the wider one stays")
                step, base = wider, wider.base
            elif not context.out_of_time and (narrower := sharper_for_an_effect(step, context)):
                wider, base = step, narrower
                continue
            return replace(
                found,
                steps=(*steps, step),
                final=base,
                accepted=tuple(accepted),
                stopped=step.minor or (OUT_OF_TIME if step.left_out else NONE_PASSES),
                withdrawn=step.minor,
            )
        base, accepted, dropped = without_needless(
            step.accepted.trial.refit, [*accepted, *step.taken], context, len(step.taken)
        )
        steps.append(replace(step, dropped=dropped))
        wider = None
        took = time.monotonic() - began
        if why := two_mixed_classes(base, accepted, context):
            return replace(found, steps=tuple(steps), final=base, accepted=tuple(accepted), stopped=why)


def _gone_back(
    steps: Sequence[Step], last: Refit, context: Context, gone_back: set[int], stopped: str
) -> Back | None:
    """The steps up to one that should have taken another effect, with that one, the model there and what it
    holds; None if there is no such step. A search goes back once to each step, noted in ``gone_back``; where
    it is ``stopped``, only to another member of a class."""
    if stopped:
        in_time = stopped != OUT_OF_TIME and not context.out_of_time
        return led_by_the_better(steps, last, gone_back, context) if in_time else None
    better = better_branch(steps, last, gone_back, context)
    if better is None:
        return None
    gone_back.add(better.number)
    earlier = steps[better.number]
    step = decided(earlier.base, without_the_better(earlier, better), context)
    if step.accepted is None or step.accepted.name != better.rival.candidate.name:
        step = both_taken(earlier, better, context)
    if step.accepted is None or step.accepted.trial.refit is None:
        return None
    context.say(f"with {better} less error is left: back to step {better.number + 1}: {said_of(step)}")
    return back_at([*steps[: better.number], step])


def _outdone(sharp: Refit, steps: Sequence[Step], context: Context) -> str:
    """Which effect explains more in the place of an accepted one with sign(v) smoothed as in ``sharp``, of
    those that took at least half as much in its step: ``one than the other``; empty if none does. What was
    taken out again has no place."""
    rules, present = context.rules, {term.name for term in sharp.model.terms}
    given = [
        (sharp, one.name, rival.candidate, context.split, rival.refit.values)
        for step in steps
        for one in step.taken
        if one.name in present
        for rival in step.trials
        if rival.refit and rival not in one.alike and rival.taken >= rules.majority * one.trial.taken
    ]
    others = list(context.mapper(exchanged, given))
    for (_, name, rival, *_), other in zip(given, others, strict=True):
        better = compare(sharp.score, other.score) if other is not None else None
        if better and better.gain >= rules.tie and better.p_value <= rules.alpha:
            return f"{rival.name} than {name}"
    return ""


def _begun_anew(found: Search, sharp: Refit, better: str, context: Context) -> Search:
    """The search from the declared model of ``found``, with sign(v) smoothed as narrowly as in ``sharp``,
    where ``better`` explains more."""
    context.say(f"the search begins anew with that, as less error is left with {better}")
    first = found.first
    model = replace(first.model, adjustments=sharp.model.adjustments)
    values = {p.name: first.values[p.name] for p in model.parameters if not p.fixed}
    numerics = replace(first.numerics, finer=sharp.numerics.finer)
    declared = context.one(refit, model, context.split, [values], None, numerics, CONTINUATION)
    return continued(Search((), declared, (), ""), context, anew=True)


def _step_as_smooth(base: Refit, context: Context, number: int, wider: Refit | None) -> Step:
    """The step beside ``base``, or beside ``wider``, whose sign(v) is smoothed more widely, if what is
    accepted there leaves less."""

    def made(beside: Refit) -> Step:
        return each_with_its_own(_unless_minor(_step(beside, context, number), context), context)

    step = made(base)
    if wider is None or not explains_more_wider(step, wider, context):
        return step
    again = made(wider)
    return again if again.loss < step.loss else step


def _step(base: Refit, context: Context, number: int) -> Step:
    """Try every candidate beside ``base`` and accept the best that passes and survives other numerics."""
    trials, left_out = trials_of(base, context, f"step {number}")
    judged = cross_fitted(judge(trials, context.rules), base, context)
    if left_out:  # one of these may explain more than what passed
        return Step(base, tuple(judged), None, left_out=left_out)
    return decided(base, judged, context)


def decided(base: Refit, judged: Sequence[Trial], context: Context) -> Step:
    """Accept the best of the ``judged`` trials beside ``base`` that passes and survives other numerics."""
    rules = context.rules
    otherwise: Otherwise = {}
    while True:
        passed = [t for t in judged if t.status == PASSED]
        if not passed:
            return Step(base, tuple(judged), None)
        best, members = _class_of(_preferred(passed, rules), judged, context)
        survivals = survivals_of(base, best, context, otherwise)
        why = objection(survivals)
        if not why:
            alike, unsteady = of_constant_amplitude(members, context)
            judged = [unsteady.get(t.candidate.name, t) for t in judged]
            if best in alike:
                return Step(base, tuple(judged), Accepted(best, alike, survivals))
            continue
        withdrawn = replace(best, status=REJECTED, reason=f"withdrawn: {why}")
        judged = [withdrawn if t is best else t for t in judged]


def _class_of(best: Trial, judged: Sequence[Trial], context: Context) -> tuple[Trial, tuple[Trial, ...]]:
    """What stands for the class of ``best``, and the class: of those that only the smoothing of sign(v) tells
    from it the one with the fewest parameters, if that is fewer than its own."""
    members = equivalents(best, judged, context.rules, _leaves_the_noise(best, context))
    smoothed = rivals_smoothed_apart(best, members, judged, context)
    first = min([best, *smoothed], key=lambda t: (t.free_parameters, -t.gain))
    return first, (first, *(t for t in (*members, *smoothed) if t is not first))


def _leaves_the_noise(trial: Trial, context: Context) -> bool:
    return trial.refit is not None and context.meets_noise(trial.refit.score)


def of_constant_amplitude(
    alike: tuple[Trial, ...], context: Context
) -> tuple[tuple[Trial, ...], dict[str, Trial]]:
    """Of a class, the members that keep their amplitudes in the held-out records, and the others by name,
    refused for that. All members, where none that passed does: then the last model decides.
    """
    fitted = [t.refit for t in alike if t.refit is not None]
    if len(fitted) == 1:
        return alike, {}
    refused = {}
    for one, here, there in zip(alike, fitted, fitted_to_held_out(fitted, context), strict=True):
        name = one.candidate.name
        if why := moved(here, there, name, context.rules):
            refused[name] = replace(one, status=REJECTED, reason=why)
    kept = tuple(t for t in alike if t.candidate.name not in refused)
    return (kept, refused) if any(t.status == PASSED for t in kept) else (alike, {})


def _unless_minor(step: Step, context: Context) -> Step:
    """``step`` without what is minor: a learned effort beside the same model takes far more."""
    one = step.accepted
    passed = [trial for trial in step.trials if trial.status == PASSED]
    most = max(passed, key=lambda t: t.taken, default=None)
    if one is None or most is None or not may_be_minor(most, step.base, context):
        return step
    learned = ceilings(step.base, context)
    asked = [most] if one.name == most.candidate.name else passed
    minor = minor_beside(asked, step.base, learned, context)
    larger = minor.get(most.candidate.name)
    refused = dict.fromkeys((t.candidate.name for t in passed), larger) if larger else minor
    if one.name not in refused:
        return replace(step, learned=learned)

    def judged(trial: Trial) -> Trial:
        beside = refused.get(trial.candidate.name)
        said = said_of_minor(trial, step.base, beside) if beside else ""
        return replace(trial, status=REJECTED, reason=f"{MINOR}{said}") if beside else trial

    trials = [judged(trial) for trial in step.trials]
    if larger is None:
        return replace(decided(step.base, trials, context), learned=learned)
    said = f"{one.name} is minor: {said_of_minor(one.trial, step.base, larger)}"
    return replace(step, trials=tuple(trials), accepted=None, learned=learned, minor=said)


def _preferred(passed: Sequence[Trial], rules: Rules) -> Trial:
    """The best held-out error; among those alike, the one with the fewest parameters. Of several with as few,
    those that leave the least error on the fitted horizons come first: where the held-out ones cannot tell
    models of one size apart, the likelihood of the others may."""
    best = max(passed, key=lambda t: t.gain)
    alike = [best, *(t for t in passed if t is not best and indistinguishable(best, t, rules))]
    fewest = min(t.free_parameters for t in alike)
    small = [t for t in alike if t.free_parameters == fewest]
    likely = (1.0 - max(t.fitted_gain for t in small)) / (1.0 - rules.tie) ** 2
    return max((t for t in small if 1.0 - t.fitted_gain <= likely), key=lambda t: t.gain)


def without_needless(
    refitted: Refit, accepted: list[Accepted], context: Context, new: int = 1
) -> tuple[Refit, list[Accepted], tuple[str, ...]]:
    """Take out again each accepted effect that the last ``new`` ones have made needless."""
    dropped: list[str] = []
    for one in accepted[: len(accepted) - new]:
        model, values = refitted.model.without(one.name), values_without(refitted, one.name)
        given = (model, context.split, [values], refitted, refitted.numerics, math.inf)
        poorer = context.one(refit_if_possible, *given)
        if poorer is None:
            continue
        evidence = compare(poorer.score, refitted.score)
        if not context.rules.passes(evidence.gain, evidence.p_value):
            refitted = poorer
            dropped.append(one.name)
    return refitted, [one for one in accepted if one.name not in dropped], tuple(dropped)
