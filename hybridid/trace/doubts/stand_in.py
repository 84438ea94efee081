"""Withdraws effects that only stand in for something that the library does not hold.

A machine may do something that the library cannot name. One effect still resembles it more than the others
do, and that one would be accepted: negative drag in place of an eddy-current brake. So a learned effort is
put beside each accepted effect. With L the held-out loss before the effect, after it (with all later
effects), and with the learned effort beside these,

    share = (L_after^2 - L_learned^2) / ((L_before^2 - L_own^2) + (L_after^2 - L_learned^2)),

L_own being the loss right after the effect was accepted. A share above ``Rules.stands_in`` has two possible
causes: the machine lacks two things, or the name is wrong. So has a learned effort that takes most of what is
left, where that is far above the noise: with a good sensor an effect may take nearly all of the squared error
by resemblance, and still leave many times the noise. To tell the causes apart, the effect is removed and
the learned effort stays. Two things then show that the learned effort can replace it. The effect took less
than ``Rules.kept`` of what it took alone; and the learned effort in its place explains the records better,
by more than ``Rules.tie`` and significantly. (It would, if the machine had a function of that
variable. Where a dozen bumps do only as well as a law of one parameter, the simpler law stays.) Then the
effect is withdrawn, and with it all that was accepted later. The gain of the learned effort must survive
other numerics. (Where friction sticks, smoothing it leaves an error over velocity that is no effect.)

Where the effect is itself a curve over the learned variable, the learned effort contains it, and adds up what
else there is over that variable. It always replaces it. So it counts against the effect only if it takes
more than the effect does: a share above ``1 - Rules.majority``.

An effect that the records do not determine is refused as a name. Yet it may show that something else explains
more: how well a model explains the records does not depend on how well they tell its parameters. So every
such effect that still takes a significant share beside the last model is held against the accepted ones as a
learned effort is, but for those to which it is declared to look alike.

Several effects together may take so much of an unknown effort that a learned effort beside them finds little.
So one learned effort is also put in place of them all. If it alone takes more from the squared error, by a
share above ``Rules.stands_in``, they are withdrawn. A periodic effect that shows less than three periods is
such a curve, too, and so is a contact that is never left: it is not accepted, but where it explains more than
the accepted effects do, these are withdrawn.

An effect that is alone in its class claims its form. Another function of the same variable that explains the
records better, with no more parameters, refutes it (``hybridid.trace.doubts.other_form``).

Last, every test above asks whether an effect explains more than noise would. Where the error that is left is
far above the noise, most of it comes from something unknown, and every flexible law resembles a part of that.
There the accepted effects are names only if, together, they take most of the squared error.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from hybridid.effects.composed import form_over
from hybridid.naming import listed
from hybridid.trace.context import Context
from hybridid.trace.doubts.other_form import other_form
from hybridid.trace.horizons.evidence import compare
from hybridid.trace.horizons.split import Split
from hybridid.trace.learned.ceiling import Ceiling
from hybridid.trace.learned.law_curve import ONE_CURVE, share_over
from hybridid.trace.learned.varying import not_constant
from hybridid.trace.noise_floor.accuracy import Accuracy
from hybridid.trace.refits.doing_nothing import no_better_than_nothing
from hybridid.trace.refits.refit import refit_if_possible
from hybridid.trace.refits.refitted import Refit, values_without
from hybridid.trace.rules import Rules
from hybridid.trace.search.steps import WITHDRAWN, Accepted, Search, Step
from hybridid.trace.trials.alike import related, strangers
from hybridid.trace.trials.constancy import fitted_to_held_out, moved
from hybridid.trace.trials.robustness import surviving
from hybridid.trace.trials.trial import REJECTED, UNIDENTIFIABLE, Trial


def without_stand_ins(found: Search, ceilings: Sequence[Ceiling], context: Context) -> Search:
    """``found`` without the first effect that stands in for another, and without those after it.

    A learned effort whose gain does not survive other numerics is no evidence against an effect.
    """
    split, rules = context.split, context.rules
    significant = [c for c in ceilings if c.p_alone <= rules.alpha and c.gain > 0]
    far = bool(significant) and not _leaves_little(found, context)
    for learned in sorted(significant, key=lambda c: -c.gain):
        accused = _accused(found, learned, far, split, rules)
        if accused is None:
            return found
        if surviving([learned.refit], found.final, context):
            return _ended_at(found, *accused)
    return found


def unless_rivalled(found: Search, context: Context) -> Search:
    """``found`` without the first effect in whose place an undetermined one explains more, and without those
    after it."""
    rules, split = context.rules, context.split
    last = found.steps[-1] if found.steps else None
    if last is None or last.base is not found.final:
        return found
    rivals = [t for t in last.trials if t.status == UNIDENTIFIABLE and not t.not_shown]
    kept = {one.name for one in found.accepted}
    for rival in sorted(rivals, key=lambda t: -t.gain):
        both = rival.refit
        assert both is not None
        for number, step in enumerate(found.steps):
            for one in (one for one in step.taken if one.name in kept and not related(one.trial, rival)):
                share = rival.taken / (one.trial.taken + rival.taken)
                if share > rules.stands_in and not _needed(found, one, both, split, rules):
                    return _ended_at(found, number, f"{rival.candidate.name} in its place explains more")
    return found


def without_mixed_classes(found: Search, context: Context) -> Search:
    """``found`` without the first effect whose class shares nothing physical, and without those after it.

    The members of a class explain the records equally well. Where they are declared look-alikes, or the same
    law at several ports, the class is a finding. Where they are not, they have only their flexibility in
    common: the truth is something else, to which each of them can bend.

    A law with one parameter and no state cannot bend. If all members are such laws, and noise and simulation
    are about all that is left, these records cannot show which of them it is (a hole in a tank, or the scale
    of the gauge of the next one). So the class stays.
    """
    now = {one.name: one for one in found.accepted}
    for number, step in enumerate(found.steps):
        for one in (now[taken.name] for taken in step.taken if taken.name in now):
            unrelated = [t.candidate.name for t in strangers(one.trial, one.alike)]
            if unrelated and not (all(map(_is_rigid, one.alike)) and _leaves_little(found, context)):
                it = one.name if len(step.taken) > 1 else "it"
                why = f"these records cannot tell {it} from {listed(unrelated)}, physically unrelated to it"
                return _ended_at(found, number, why)
    return found


def _is_rigid(trial: Trial) -> bool:
    """Whether the law has one free parameter and no state."""
    effect = trial.candidate.effect
    return not effect.states and sum(not p.fixed for p in effect.parameters) == 1


def _leaves_little(found: Search, context: Context) -> bool:
    """Whether the last model leaves no more than a complete one may (``Rules.far``)."""
    final = found.final
    return found.at_noise or Accuracy.of(final, context).times(final.score.rmse) <= context.rules.far


def _accused(
    found: Search, learned: Ceiling, far: bool, split: Split, rules: Rules
) -> tuple[int, str] | None:
    """The step whose effect a learned effort shows to stand in for another, and how. ``far``: what is left is
    far above the noise."""
    left = found.final.score.loss**2
    takes = left - learned.refit.score.loss**2
    most_of_it = far and takes >= rules.majority * left
    kept = {one.name for one in found.accepted}
    for number, step in enumerate(found.steps):
        for one in (one for one in step.taken if one.name in kept):
            share = takes / (one.trial.taken + takes)
            asked = share > rules.stands_in or most_of_it
            if asked and _contained(found.final, one, learned, split):
                asked = share > 1 - rules.majority
            if asked and not _needed(found, one, learned.refit, split, rules):
                it = one.name if len(step.taken) > 1 else "it"
                said = f"{takes / left:.0%} of the squared error that is left"
                if share > rules.stands_in:
                    said = f"{share:.0%} of what both take from the squared error"
                return number, f"beside {it} {learned.described} still takes {said}"
    return None


def _contained(final: Refit, one: Accepted, learned: Ceiling, split: Split) -> bool:
    """Whether the effect is a curve over the variable of the learned effort, which then contains it.

    In an oscillation a spring force is nearly proportional to the acceleration. A learned effort over the
    acceleration could take the spring's place, but would leave what no curve over the acceleration follows.
    One that leaves less than that does not owe its success to the spring.
    """
    effect = one.trial.candidate.effect
    if learned.port not in one.trial.candidate.ports:
        return False
    share = share_over(final, one.name, learned.port, learned.over, split)
    if share < ONE_CURVE or form_over(effect) == learned.over:
        return share >= ONE_CURVE
    return (1 - share) * one.trial.taken <= learned.refit.score.loss**2


def unless_outdone(found: Search, before: Sequence[Ceiling], rules: Rules) -> Search:
    """``found`` without its effects if one curve does better than all of them: one of ``before``, learned
    efforts beside the declared model, or in any step an effect whose form the records do not show."""
    kept = {one.name for one in found.accepted}
    learned = [(0, c.refit, f"{c.described} alone") for c in before]
    bent = [
        (number, t.refit, f"{t.candidate.name}, whose form the records do not show,")
        for number, step in enumerate(found.steps)
        if any(one.name in kept for one in step.taken)
        for t in step.trials
        if t.status == UNIDENTIFIABLE and t.not_shown and t.refit is not None
    ]
    named = found.final.score.loss**2
    for number, curve, what in sorted([*learned, *bent], key=lambda one: one[1].score.loss):
        declared, left = (r.score.loss**2 for r in (found.steps[number].base, curve))
        outdone = named - left > rules.stands_in * (declared - left)
        if outdone and compare(found.final.score, curve.score).p_value <= rules.alpha:
            return _ended_at(
                found,
                number,
                f"{what} takes {1 - left / declared:.1%} of the squared error, all effects accepted take "
                f"{1 - named / declared:.1%}",
            )
    return found


def unless_minor(found: Search, times: float, rules: Rules) -> Search:
    """``found`` without its effects if they take less than most of the squared error and leave far more than
    noise and simulation do: the error left is ``times`` theirs."""
    if not found.accepted or times <= rules.far:
        return found
    taken = 1 - found.final.score.loss**2 / found.first.score.loss**2
    if taken >= rules.majority:
        return found
    names = listed([one.name for one in found.accepted])
    return _ended_at(
        found,
        next(number for number, step in enumerate(found.steps) if step.taken),
        f"with {names} the squared error falls by {taken:.0%}, to {times:.1f} times the error that noise and "
        "simulation alone leave: most of what is missing is something else",
    )


def unless_varying(found: Search, context: Context) -> Search:
    """``found`` without the first accepted effect whose amplitude is no constant, and without those after it.

    See ``hybridid.trace.learned.varying``. Where the search ended at the noise, nothing is left to explain.
    """
    if not found.accepted or found.at_noise:
        return found
    accused = not_constant(found.final, [one.name for one in found.accepted], context)
    if accused is None:
        return found
    name, why = accused
    return _ended_at(found, _step_of(found, name), why)


def unless_another_form(found: Search, context: Context) -> Search:
    """``found`` without the first accepted effect whose form another one outdoes, and without those after it.

    See ``hybridid.trace.doubts.other_form``. Laws over its variable are tried then, whatever a learned effort
    finds.
    """
    outdone = other_form(found, context)
    if outdone is None:
        return found
    kept = _ended_at(found, _step_of(found, outdone.name), outdone.why)
    return replace(kept, other_laws=(*found.other_laws, (outdone.port, outdone.over)))


def unless_no_better_than_nothing(found: Search, context: Context) -> Search:
    """``found`` without what was accepted, if its last model predicts no better than a constant does."""
    if not found.accepted or found.at_noise or not no_better_than_nothing(found.final, context.split):
        return found
    number = next(k for k, step in enumerate(found.steps) if step.taken)
    return _ended_at(found, number, "with it the model predicts each horizon no better than a constant does")


def unless_moved(found: Search, context: Context) -> Search:
    """``found`` without the first accepted effect whose amplitude is another one in the held-out records, and
    without those after it.

    See ``hybridid.trace.trials.constancy``. Where the search ended at the noise, nothing is left to explain.
    """
    if not found.accepted or found.at_noise:
        return found
    (there,) = fitted_to_held_out([found.final], context)
    kept = {one.name for one in found.accepted}
    for number, step in enumerate(found.steps):
        for name in (one.name for one in step.taken if one.name in kept):
            if why := moved(found.final, there, name, context.rules):
                return _ended_at(found, number, f"{why}. The machine changed, or the law is another one")
    return found


def _needed(found: Search, one: Accepted, both: Refit, split: Split, rules: Rules) -> bool:
    """Whether the effect takes its part beside another one, as in ``both``, or does more in its place."""
    alone = refit_if_possible(
        both.model.without(one.name), split, [values_without(both, one.name)], both, both.numerics
    )
    if alone is None:
        return True
    better = compare(found.final.score, alone.score)
    if better.gain < rules.tie or better.p_value > rules.alpha:
        return True
    return alone.score.loss**2 - both.score.loss**2 >= rules.kept * one.trial.taken


def _step_of(found: Search, name: str) -> int:
    """The step that accepted the effect ``name``."""
    return next(k for k, step in enumerate(found.steps) if name in [one.name for one in step.taken])


def _ended_at(found: Search, number: int, why: str) -> Search:
    """The search as if the step ``number`` had found nothing."""
    step = found.steps[number]
    name, reason = " + ".join(one.name for one in step.taken), f"{WITHDRAWN}: {why}"
    trials = tuple(
        replace(t, status=REJECTED, reason=reason) if t.candidate.name == name else t for t in step.trials
    )
    pairs = tuple(replace(p, status=REJECTED, reason=reason) if p.name == name else p for p in step.pairs)
    ended: Step = replace(step, trials=trials, pairs=pairs, accepted=None, together=None)
    present = {term.name for term in step.base.model.terms}  # with what this step or a later one took out
    before = [one for taken in found.steps[:number] for one in taken.taken]
    kept = {one.name: one for one in (*before, *found.accepted) if one.name in present}
    return replace(
        found,
        steps=(*found.steps[:number], ended),
        final=step.base,
        accepted=tuple(kept.values()),
        stopped=f"{name} {reason}",
        withdrawn=reason,
    )
