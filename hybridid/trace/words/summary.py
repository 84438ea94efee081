"""From the evidence of a trace to its plain numbers and words."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

from hybridid.declarations import Parameter
from hybridid.effects.composed import FORMS, is_composed
from hybridid.estimators import Estimate
from hybridid.naming import listed
from hybridid.quantities import Z95
from hybridid.records.record import Record
from hybridid.trace.entries import (
    AcceptedEffect,
    EstimatedValue,
    Floor,
    LearnedGain,
    ReplacedEffect,
    StepTaken,
    TriedEffect,
    TriedPair,
    UsedRecord,
    Value,
)
from hybridid.trace.learned.ceiling import Ceiling
from hybridid.trace.refits.refitted import Refit
from hybridid.trace.results.before_after import FITTED, HELD_OUT, Validation
from hybridid.trace.results.completeness import completeness
from hybridid.trace.results.idle import either_of, idle_terms
from hybridid.trace.results.result import Estimates, Evidence, LearnedGains, Trace
from hybridid.trace.rules import Rules
from hybridid.trace.search.revision import Replacement
from hybridid.trace.search.steps import Accepted, Search
from hybridid.trace.trials.pair import PairTrial
from hybridid.trace.trials.robustness import Survival
from hybridid.trace.trials.trial import PASSED, REJECTED, UNIDENTIFIABLE, Trial
from hybridid.trace.verdict import Conclusion
from hybridid.trace.words.levels import level, path_of
from hybridid.trace.words.refused_words import why_passed_over

ROUNDING = 1e-9
"""Of a value: the width of an interval that no record with noise can give."""


def summary(evidence: Evidence, rules: Rules, validation: Validation, seconds: float) -> Trace:
    """The trace that ``evidence`` shows, its sentence left empty; ``seconds`` is how long it took."""
    found, split, networks = evidence.conclusion, evidence.split, evidence.networks
    first, last = evidence.models[0], evidence.models[-1]
    return Trace(
        provenance=listed(sorted({record.provenance for record in split.records})),
        verdict=found.verdict,
        sentence="",
        accepted=accepted_effects(found.search, last.estimate, found.there),
        rejected=rejected_effects(found.search),
        before=(*first.rows, *(networks[0].rows if networks else ())),
        after=(*last.rows, *(networks[-1].rows if networks else ())),
        noise_floor=_floors(found),
        seconds=seconds,
        declared=tuple(term.name for term in first.model.terms),
        effects=tuple(term.name for term in found.model.terms),
        estimates=Estimates(estimated_values(first.estimate), estimated_values(last.estimate)),
        path=path_of(found.search),
        ceilings=LearnedGains(learned_gains(evidence.ceilings[0]), learned_gains(evidence.ceilings[-1])),
        remains=found.remains,
        times=found.times,
        times_fitted=found.times_fitted,
        refused=found.refused,
        steady=found.steady,
        longer=found.longer,
        noisy=found.noisy,
        too_short=found.too_short,
        vague=found.vague,
        completeness=completeness(networks, rules),
        stopped=found.search.stopped,
        withdrawn=found.search.stopped if found.search.withdrawn else "",
        split=split.described,
        horizon=validation.seconds,
        horizons=(len(split.fitted), len(split.held_out)),
        rules=rules,
        records=used_records(validation.fitted, validation.others),
        steps=steps_taken(found.search),
        idle=idle_terms(evidence.models[0].model, last.estimate),
        either=either_of(evidence.models[0].model, last.estimate),
        replacements=tuple(map(_replaced, found.replacements)),
        refused_laws=refused_laws(found.search),
        laws_formed=found.search.laws_formed,
        in_place_of=found.search.in_place_of,
        evidence=evidence,
    )


def _floors(found: Conclusion) -> dict[str, Floor]:
    """What a complete model would leave of each output."""
    known = found.accuracy
    by_output = zip(found.model.outputs, known.noise, known.simulation, known.parameters, strict=True)
    return {y.name: Floor(float(n), y.unit, float(s), float(p)) for y, n, s, p in by_output}


def _replaced(one: Replacement) -> ReplacedEffect:
    model = one.refit.model
    return ReplacedEffect(
        one.left_out,
        tuple(accepted.name for accepted in one.accepted),
        one.kind,
        one.gain,
        one.p_value,
        one.fewer,
        dict(zip((y.name for y in model.outputs), one.refit.score.rmse.tolist(), strict=True)),
        {
            p.name: Value(one.refit.values[p.name], one.refit.std.get(p.name, math.nan), p.unit)
            for p in model.parameters
            if not p.fixed
        },
    )


def accepted_effects(
    search: Search, estimate: Estimate, there: Refit | None = None
) -> tuple[AcceptedEffect, ...]:
    """The accepted effects with their evidence; their parameters are from ``estimate``, the last fit.

    ``there`` is the last model, fitted to the held-out horizons alone.
    """
    return tuple(_accepted(one, search, estimate, there) for one in search.accepted)


def rejected_effects(search: Search) -> tuple[TriedEffect, ...]:
    """Every effect that was tried and not accepted, as it was last judged, the largest gain first."""
    accepted = {one.name for one in search.accepted}
    last: dict[str, tuple[int, Trial]] = {}
    for number, step in enumerate(search.steps, 1):
        last |= {trial.candidate.name: (number, trial) for trial in step.trials}
    entries = [
        _at_the_end(search, trial, number) for name, (number, trial) in last.items() if name not in accepted
    ]
    return tuple(sorted(entries, key=lambda entry: -entry.gain))


def refused_laws(search: Search) -> tuple[TriedEffect, ...]:
    """The composed laws that were tried beside the last model and refused, the largest gain first."""
    tried = sorted(search.refused_laws, key=lambda trial: -trial.gain)
    return tuple(_tried(trial, len(search.steps)) for trial in tried)


def steps_taken(search: Search) -> tuple[StepTaken, ...]:
    """Every step with all its trials, the largest gain first."""
    return tuple(
        StepTaken(
            level(f"before step {number}", step.base),
            step.accepted.name if step.accepted else None,
            step.dropped,
            tuple(_tried(t, number) for t in sorted(step.trials, key=lambda t: -t.gain)),
            tuple(map(_tried_pair, sorted(step.pairs, key=lambda pair: -pair.gain))),
            step.family,
            step.together.name if step.together else None,
            step.left_out,
        )
        for number, step in enumerate(search.steps, 1)
    )


def estimated_values(estimate: Estimate) -> dict[str, EstimatedValue]:
    """Estimates by name with their 95 % intervals, within their bounds."""
    return {
        p.name: EstimatedValue(
            p.value,
            p.std,
            p.unit,
            (max(p.value - Z95 * p.std, p.lower), min(p.value + Z95 * p.std, p.upper)),
            p.at_bound,
            p.identifiable,
            p.meaning,
        )
        for p in estimate.parameters
    }


def learned_gains(found: Sequence[Ceiling]) -> tuple[LearnedGain, ...]:
    """The ceilings without their curves and refits."""
    return tuple(
        LearnedGain(
            port=c.port,
            over=str(c.over),
            gain=c.gain,
            p_value=c.p_value,
            unit=c.unit,
            over_unit=c.over_unit,
            failure=c.failure,
            ended_early=c.refit.ended_early,
            kind=c.kind,
            fitted=c.fitted,
        )
        for c in found
    )


def used_records(fitted: Sequence[Record], held_out: Sequence[Record]) -> tuple[UsedRecord, ...]:
    """The records with their roles."""
    roles = [*((record, FITTED) for record in fitted), *((record, HELD_OUT) for record in held_out)]
    return tuple(UsedRecord(r.name, role, r.provenance, r.source, r.digest, r.n, r.dt) for r, role in roles)


def _accepted(one: Accepted, search: Search, estimate: Estimate, there: Refit | None) -> AcceptedEffect:
    trial, effect, prefix = one.trial, one.trial.candidate.effect, f"{one.name}."
    number, left = _step_of(search, one), search.final.score.loss
    assert trial.refit is not None
    declared = {p.name: p for p in trial.refit.model.parameters}
    own = {
        p.name.removeprefix(prefix): _told(declared[p.name], p.value, p.std)
        for p in estimate.parameters
        if p.name.startswith(prefix)
    }
    return AcceptedEffect(
        effect=effect.id,
        port=trial.candidate.port,
        title=effect.title,
        equation=effect.equation,
        pattern=effect.pattern,
        source=effect.source,
        parameters=own,
        known={
            name.removeprefix(prefix): Value(value, math.nan, declared[name].unit)
            for name, value in estimate.known.items()
            if name.startswith(prefix)
        },
        alike=tuple(dict.fromkeys(t.candidate.effect.id for t in one.alike)),
        class_members=tuple(replace(_tried(t, number), more=_more(t, left)) for t in one.alike),
        separating_experiments=_separating(one),
        p_value=trial.p_adjusted,
        gain=trial.gain,
        at_step=trial.own("values"),
        likelihood_gain=trial.comparison.likelihood_gain if trial.comparison else math.nan,
        step=number,
        survivals=tuple(map(_short, one.survivals)),
        is_law=is_composed(effect),
        form_of=FORMS.get(effect.id, ""),
        together=one.together,
        by_held_out={} if there is None else {n: _value(there, declared[prefix + n]) for n in own},
    )


def _more(member: Trial, left: float) -> float:
    """The share of error that a member of a class leaves beyond ``left``."""
    return member.refit.score.loss / left - 1.0 if member.refit and left > 0 else 0.0


def _value(fitted: Refit, parameter: Parameter) -> Value:
    name = parameter.name
    return _told(parameter, fitted.values[name], fitted.std.get(name, math.nan))


def _told(parameter: Parameter, value: float, std: float) -> Value:
    """Without a standard error where the 95 % interval is wider than all that is allowed, or so narrow that
    only rounding errors make it."""
    known = ROUNDING * abs(value) <= 2 * Z95 * std <= parameter.upper - parameter.lower
    return Value(value, std if known else math.nan, parameter.unit)


def _short(found: Survival) -> Survival:
    """With its parameters by their short names."""
    short = {name.rsplit(".", 1)[-1]: value for name, value in found.parameters.items()}
    return replace(found, parameters=short)


def _step_of(search: Search, one: Accepted) -> int:
    numbers = [
        k for k, step in enumerate(search.steps, 1) if any(taken.name == one.name for taken in step.taken)
    ]
    return numbers[-1] if numbers else 0


def _separating(one: Accepted) -> tuple[str, ...]:
    """What to record so that the members of a class come apart."""
    asked = [t.candidate.effect.separating_experiment for t in one.alike] if len(one.alike) > 1 else []
    return tuple(dict.fromkeys(text for text in asked if text))


def _at_the_end(search: Search, trial: Trial, number: int) -> TriedEffect:
    """What passed but was not accepted belongs to a class, or others explained more."""
    tried = _tried(trial, number)
    for one in search.accepted:
        if any(t.candidate == trial.candidate for t in one.alike):
            reason = f"these records cannot tell it from {one.name}"
            return replace(tried, status=UNIDENTIFIABLE, reason=reason, class_of=one.name)
    if trial.status == PASSED:
        taken, cut = search.steps[number - 1].taken, search.cut_within_a_step
        why = "but others are untried" if cut else why_passed_over(trial, taken)
        return replace(tried, status=REJECTED, reason=f"{trial.reason}, {why}")
    return tried


def _tried_pair(pair: PairTrial) -> TriedPair:
    first, second = (candidate.name for candidate in pair.candidates)
    found = pair.refit
    units = {p.name: p.unit for p in found.model.parameters} if found else {}
    return TriedPair(
        effects=(first, second),
        status=pair.status,
        reason=pair.reason,
        promised=pair.promised,
        gain=pair.gain if pair.comparison else -1.0,
        gains=tuple(member.gain for member in pair.members),
        p_value=pair.p_adjusted if pair.comparison else 1.0,
        parameters={
            name: Value(value, found.std.get(name, math.nan), units[name])
            for name, value in (found.values.items() if found else ())
            if found and name.startswith((f"{first}.", f"{second}."))
        },
        seconds=pair.seconds,
    )


def _tried(trial: Trial, number: int) -> TriedEffect:
    found, comparison = trial.refit, trial.comparison
    prefix = f"{trial.candidate.name}."
    free = [p for p in found.model.parameters if not p.fixed] if found and comparison else []
    own = {p.name.removeprefix(prefix): _value(found, p) for p in free if found and p.name.startswith(prefix)}
    return TriedEffect(
        effect=trial.candidate.effect.id,
        port=trial.candidate.port,
        status=trial.status,
        reason=trial.reason,
        step=number,
        gain=trial.gain if comparison else -1.0,
        p_value=trial.p_adjusted if comparison else 1.0,
        parameters=own,
        seconds=trial.seconds,
        is_law=is_composed(trial.candidate.effect),
    )
