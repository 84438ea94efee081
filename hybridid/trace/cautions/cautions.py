"""What speaks against taking a verdict at its word, told behind it."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Sequence
from dataclasses import replace

import numpy as np
from scipy.stats import norm

from hybridid.advice.advice import Advice
from hybridid.advice.decay import free_decay
from hybridid.advice.relaxation import relaxation
from hybridid.advice.unequal import unequal_outputs
from hybridid.model import Model
from hybridid.naming import listed
from hybridid.quantities import estimated, multiple, quantity, share
from hybridid.records.record import Record
from hybridid.trace.cautions.at_bound import ends_at_bound
from hybridid.trace.cautions.constants import WrongConstants, constants_in_words
from hybridid.trace.cautions.decay_class import in_their_place
from hybridid.trace.cautions.doubted import one_curve, other_law_possible, revision_advised, simpler_possible
from hybridid.trace.cautions.drive_sides import drive_changes_on_one_side
from hybridid.trace.cautions.form_shown import form_hardly_shown
from hybridid.trace.cautions.free_run import (
    adds_up_in_free_run,
    far_in_free_run,
    unstable,
    worse_in_free_run,
)
from hybridid.trace.cautions.horizon_advice import (
    determining_parts_advised,
    few_samples,
    other_horizons_advised,
    parts_of_all_advised,
    slower_dynamics,
)
from hybridid.trace.cautions.memory_begins import memory_begins_empty
from hybridid.trace.cautions.one_way import judged_the_other_way
from hybridid.trace.cautions.sampling import outputs_late, recorded_late, within_half_a_sample
from hybridid.trace.cautions.shared_constant import shares_a_constant
from hybridid.trace.cautions.smeared import smoothing_may_be_all
from hybridid.trace.context import Context
from hybridid.trace.doubts.hystereses import one_impedance, several_hystereses, spread_relaxation
from hybridid.trace.entries import AcceptedEffect
from hybridid.trace.noise_floor.weighed import weights_in_words
from hybridid.trace.recordings.between_recordings import between_recordings
from hybridid.trace.results.idle import SURE, amplitudes_of, told_from_zero
from hybridid.trace.results.result import Trace
from hybridid.trace.rules import Rules
from hybridid.trace.search.longer import more_over_longer
from hybridid.trace.search.steps import Accepted, Search
from hybridid.trace.starts.shorter import seeks
from hybridid.trace.starts.shown import not_shown
from hybridid.trace.verdict import Conclusion
from hybridid.trace.words.refused_words import refused_for_significance
from hybridid.trace.words.told_classes import depends_on_the_member
from hybridid.validation.drift import growth, outputs_that_drift

OTHER = 0.2
"""Share of its value by which a parameter must differ to be told: a machine that warms up changes by less."""
MOST_FREE = 2
"""Parameters of an effect up to which what it takes from the fitted horizons alone is told."""
NEAR = 1e-3
"""Of its scale, within which of a bound a parameter ends there."""
LITTLE = 0.01
"""Of the squared error that all accepted effects take: what takes less is told."""
_EACH = re.compile(r" (?=Beware: )")


def cautions(
    found: Conclusion,
    traced: Trace,
    records: Sequence[Record],
    constants: WrongConstants,
    context: Context,
) -> tuple[str, ...]:
    """What speaks against taking the trace of the fitted ``records`` at its word, one by one; ``constants``
    are those that were declared and may be wrong."""
    drift = _drifting(found, context)
    told = [] if traced.by_recording or traced.disagreement else between_recordings(found, context)
    told += [constants_in_words(constants), ends_at_bound(traced.estimate)]
    told += [revision_advised(found, context)]
    told += [several_hystereses(found.accepted), one_impedance(found.accepted), one_curve(found, context)]
    told += [judged_the_other_way(found.search.first, context)]
    told += [drive_changes_on_one_side(found.model, context.split)]
    told += [within_half_a_sample(found.accepted, found.search.final, records[0].dt)]
    told += [recorded_late(found.accepted), outputs_late(found.accepted)]
    told += [told_of(found.search.final, context.split) for told_of in (slower_dynamics, few_samples)]
    if found.verdict == "unexplained":
        told += [smoothing_may_be_all(found.search.final, context)]
        told += [other_horizons_advised(found.search.final, context.split, found.accuracy.noise)]
    unconfirmed = _only_fitted(found, context) if found.verdict == "unexplained" else ""
    if unconfirmed or (found.verdict == "unexplained" and refused_for_significance(traced)):
        told += [unconfirmed, parts_of_all_advised(context.split)]
    cut = found.search.cut_within_a_step or (found.out_of_time and bool(found.accepted))
    if found.verdict == "undecided" and not (cut or traced.steady or traced.longer):
        advised = determining_parts_advised if traced.vague else parts_of_all_advised
        told += [_only_fitted(found, context), advised(context.split)]
    if found.verdict == "nothing_missing":
        told += [_hidden_by_the_simulation(traced, found.model)]
    if found.verdict == "nothing_missing" or found.accepted:
        told += [_grows(found, context.rules)]
    if traced.accepted:
        told += [other_law_possible(found, context), simpler_possible(found, context)]
        told += [shares_a_constant(found, context)]
        told += [_no_longer_shown(found.search, context)]
        told += [not_told_from_zero(found.accepted, traced), _confounded(records)]
        told += [spread_relaxation(found.model)]
        told += [memory_begins_empty(found.accepted, found.search.final, context.split)]
        told += [_more_over_longer(found, context)]
        told += [
            form_hardly_shown(found.accepted, found.search.final.score.loss, context.rules),
            _takes_little(found.search),
            _moved(found.search),
            _other_held_out(traced.accepted, context.rules),
        ]
        told += [in_their_place(found.search), depends_on_the_member(found.accepted, traced)]
    told += [_beware(unequal_outputs(records))]
    told += [weights_in_words(traced.weights)]
    still_open = found.verdict in ("undecided", "nothing_missing") and not (cut or traced.longer)
    told += [found.other_hold, _in_free_run(found.search, traced, drift, context, still_open)]
    return tuple(caution for one in told if one for caution in _EACH.split(one.strip()))


def _in_free_run(
    search: Search, traced: Trace, drift: Sequence[str], context: Context, still_open: bool
) -> str:
    """That the free runs become worse, or stay far from the noise, or say nothing since the machine is
    unstable. Where only what was accepted makes it so, that is no excuse. Where it is ``still_open`` whether
    something is missing, longer horizons are advised."""
    first, last = (
        growth(one.model, one.model.values(one.values), context.split.records)
        for one in (search.first, search.final)
    )
    if first > 0 and last > 0:
        return unstable(traced, last)
    further = far_in_free_run(traced, drift) if still_open else ""
    return worse_in_free_run(traced) or further or adds_up_in_free_run(traced, drift)


def _only_fitted(found: Conclusion, context: Context) -> str:
    """Which effect takes most of the squared error from the fitted horizons, though those that judge do not
    show it; empty if none does, or it is told already. Where few judge, one disturbance among them may hide
    what the fit shows. An effect that seeks a pitch, a place or a frequency, or has more than two parameters,
    fits anything."""
    steps, rules = found.search.steps, context.rules
    tried = steps[-1].trials if steps and not steps[-1].taken else ()
    stiff = [trial for trial in tried if not seeks(trial.candidate) and trial.free_parameters <= MOST_FREE]
    most = max(stiff, key=lambda trial: trial.fitted_gain, default=None)
    if most is None or most.fitted_gain < rules.majority or most.candidate.name in found.refused:
        return ""
    if most.refit is None or most.refit.ended_early or most.refit.too_stiff:
        return ""
    lower = most.gain >= rules.worth
    if lower and found.verdict == "unexplained":  # the refused gains are told there
        return ""
    others = f"of the others the RMSE falls by {share(most.gain)}, not significantly"
    return (
        f" {most.candidate.name} takes {share(most.fitted_gain)} of the squared error from the fitted "
        f"horizons; {others if lower else 'the others do not confirm it'}."
    )


def _grows(found: Conclusion, rules: Rules) -> str:
    """That longer horizons leave more than noise, though no more than ``Rules.far``; else empty. Noise of the
    inputs, where that is told, does that too."""
    if found.grows is None or found.noisy or found.grows.times > rules.far:
        return ""
    fitted = "" if found.grows.judged else "fitted "
    return (
        f" Beware: {fitted}over horizons of {found.grows.seconds:.2g} s the model leaves "
        f"{found.grows.times:.1f} times what noise and simulation leave: an effect that adds up slowly may "
        "be missing."
    )


def _more_over_longer(found: Conclusion, context: Context) -> str:
    """That what was accepted meets the noise here, and leaves far more over longer horizons; else empty. A
    fitted initial state may hide over a short horizon what a law of another form leaves."""
    if found.times > context.rules.far or context.out_of_time:
        return ""
    if found.grows is not None and found.grows.times <= context.rules.far:  # told already
        return ""
    longer = more_over_longer(found.search.final, context)
    if longer is None:
        return ""
    seconds, times = f"{longer.seconds:.2g}", multiple(longer.times)
    return (
        f" Beware: over horizons of {seconds} s the last model leaves {times} what noise and simulation "
        "leave. What is named may have another form, or stand for something else: "
        f"trace.horizon={seconds} asks there."
    )


def _hidden_by_the_simulation(traced: Trace, model: Model) -> str:
    """Of which outputs the simulation errs far more than the sensor: what does less stays unseen. Else
    empty."""
    far = traced.rules.far
    told = [
        f"{quantity(one.simulation, one.unit, 2)} of {name}"
        for name, one in traced.noise_floor.items()
        if one.simulation > far * one.value
    ]
    if not told or not model.smooths:
        return ""
    return (
        f" Beware: the simulation errs by {listed(told)}, far more than the sensor. What does less than that "
        "stays unseen; a smaller epsilon of the ports shows more."
    )


def _drifting(found: Conclusion, context: Context) -> list[str]:
    """The outputs that follow what the last model integrates, or what is unstable in it."""
    final, records = found.search.final, context.split.records
    drift = outputs_that_drift(final.model, final.model.values(final.values), records)
    return [output.name for output, does in zip(final.model.outputs, drift, strict=True) if does]


def marked_as_shown(accepted: Sequence[Accepted], traced: Trace) -> Trace:
    """``traced``, whose entries are those of ``accepted``, with ``shown`` False in each whose amplitudes the
    last model does not tell from zero, unless that holds for all of them.

    An effect that was determined when it was accepted may not be so beside those that followed. Then it
    stands for a part of the error, and is no name. A limit that is hard has no interval on the side of
    infinity. Of a class, another member may be shown; and a law is proposed, not named.
    """
    marked = tuple(
        replace(entry, shown=entry.is_law or len(entry.alike) > 1 or not _may_be_zero(one, traced))
        for one, entry in zip(accepted, traced.accepted, strict=True)
    )
    return replace(traced, accepted=marked) if any(entry.shown for entry in marked) else traced


def not_told_from_zero(accepted: Sequence[Accepted], traced: Trace) -> str:
    """Which of the effects that ``traced`` names as ``shown`` the last model does not tell from zero all the
    same, in words; empty if it tells all."""
    pairs = zip(accepted, traced.accepted, strict=True)
    unsure = [entry.name for one, entry in pairs if entry.shown and _may_be_zero(one, traced)]
    if not unsure:
        return ""
    its = "their intervals include" if len(unsure) > 1 else "its interval includes"
    return f" Beware: beside all others these records hardly show {listed(unsure)}: {its} zero."


def _may_be_zero(accepted: Accepted, traced: Trace) -> bool:
    """Whether the last model tells no amplitude of the effect from zero, nor all of them together."""
    if any(p.hard for p in accepted.trial.candidate.effect.parameters):
        return False
    (term,) = [one for one in traced.model.terms if one.name == accepted.name]
    own = amplitudes_of(term, traced.model, traced.estimate)
    return bool(own) and not told_from_zero(traced.estimate, own)


def _takes_little(search: Search) -> str:
    """Which accepted effects, but for the first, take little of what all take, in each output; else empty.

    A first effect whose law is off by a tenth of its amplitude leaves a hundredth of the square of what it
    takes. So what takes less than that may only mend the form of what was found before. What made an earlier
    effect needless takes what that one took, too.
    """
    instead = {one.name for step in search.steps if step.dropped for one in step.taken}
    later = [one for one in search.accepted[1:] if not (one.together or one.name in instead)]
    return "".join(
        f" Beware: {one.name} takes {share(one.trial.gain)} off the error that its step began with, and "
        f"{share(taken)} of the squared error that all take. If the law of what was found before it is off "
        "by a tenth, that alone leaves as much."
        for one, taken in ((one, _share_taken(one, search)) for one in later)
        if taken < LITTLE
    )


def _share_taken(one: Accepted, search: Search) -> float:
    """The share that an accepted effect took, in its step, from the squared error which all take; that of the
    output in which it is largest."""
    assert one.trial.refit is not None
    its = (step for step in search.steps if any(other.name == one.name for other in step.taken))
    before = next((step.base for step in its), search.first)
    levels = (search.first, search.final, before, one.trial.refit)
    first, final, base, after = (level.score.rmse**2 for level in levels)
    lower = first > final
    return float(np.max((base - after)[lower] / (first - final)[lower], initial=0.0))


def _no_longer_shown(search: Search, context: Context) -> str:
    """Of which accepted effects the last model does not show the form any more, as the model of their step
    did; else empty."""
    reasons = [
        (one.name, not_shown(one.trial.candidate, search.final, context.split)) for one in search.accepted
    ]
    return "".join(
        f" Beware: the last model no longer shows the form of {name} ({why})." for name, why in reasons if why
    )


def _moved(search: Search) -> str:
    """Which parameters of the plant are less than half or more than twice what they were, and by more than
    chance: what the records did not determine before has not moved. Else empty."""
    before, after, std = search.first.values, search.final.values, search.final.std
    vague = search.first.std
    free = [p for p in search.final.model.plant.parameters if p.name in std]
    chance = {p.name: SURE * math.hypot(std[p.name], vague.get(p.name, 0.0)) for p in free}
    sure = [p for p in free if abs(after[p.name] - before[p.name]) > chance[p.name]]
    moved = [p for p in sure if not 0.5 <= after[p.name] / (before[p.name] or math.inf) <= 2.0]
    told = [
        f"{p.name} moves from {quantity(before[p.name], p.unit, 3)} to {quantity(after[p.name], p.unit, 3)}"
        + (", its bound" if min(abs(after[p.name] - b) for b in (p.lower, p.upper)) <= NEAR * p.scale else "")
        for p in moved
    ]
    known = "compare that with what you know of the machine"
    return f" With what was accepted {listed(told)}: {known}." if told else ""


def _other_held_out(accepted: Sequence[AcceptedEffect], rules: Rules) -> str:
    """Which parameters of effects are others where the model is fitted to the held-out records alone, and by
    more than chance; else empty. A law of physics has one value of each."""
    told = []
    for one in accepted:
        both = [(name, here, one.by_held_out[name]) for name, here in one.parameters.items()]
        for name, here, there in both:
            apart = abs(here.value - there.value)
            chance = norm.isf(rules.alpha / (2 * len(both))) * math.hypot(here.std, there.std)
            if apart > chance and apart > OTHER * min(abs(here.value), abs(there.value)):
                ours, theirs = (estimated(v.value, v.std, v.unit) for v in (here, there))
                told.append(
                    f"{name} of {one.name} is {ours} in the fitted records, {theirs} in those held out"
                )
    return (
        f" Beware: {listed(told)}: the form may be another one, or the machine has changed." if told else ""
    )


def _confounded(records: Sequence[Record]) -> str:
    """That a name may stand for another one, where all records are one free decay or relaxation; else
    empty."""
    return _beware((*free_decay(records), *relaxation(records)))


def _beware(advised: Iterable[Advice]) -> str:
    return "".join(f" Beware: {one.said}." for one in advised)
