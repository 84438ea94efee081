"""Which parameters of the last model differ from recording to recording.

Each parameter in turn takes one value for each record, and all are refitted together. Horizons of the same
records that were not fitted judge, as they judge an effect: a record that is held out as a whole has no value
of its own. The parameter that explains most, also when the equations are solved another way, is kept, and the
others are tried again beside it.

A gauge whose range was changed scales an input or an output in one recording, and then all parameters seem
to differ. So the relative error of each gauge is tried as well, alone, and zero in the first record. It is
named in the place of all these parameters if it explains as much.

An effect may have been accepted in the place of such a difference (a drift within each run for friction that
changed between the runs). So each accepted effect is left out once, with each parameter by recording instead.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from hybridid.estimators.differences import chi_square_test
from hybridid.model import Model
from hybridid.model.groups import WEIGHT, of_group
from hybridid.records.record import Record
from hybridid.trace.context import Context
from hybridid.trace.entries import DifferingParameter, Value
from hybridid.trace.horizons.evidence import Comparison, compare, holm
from hybridid.trace.horizons.split import Split
from hybridid.trace.recordings.gauges import error_of, gauges, is_error_of_gauge
from hybridid.trace.refits.refit import CONTINUATION, FAILURES, refit
from hybridid.trace.refits.refitted import Refit, values_without
from hybridid.trace.rules import Rules
from hybridid.trace.search.sharper import sharp_enough
from hybridid.trace.search.steps import Search
from hybridid.trace.trials.judgement import too_little
from hybridid.trace.trials.robustness import objection, refitted_under, survival, variations
from hybridid.trace.trials.trial import PASSED, REJECTED, UNIDENTIFIABLE, UNTRIED


@dataclass(frozen=True)
class Differing:
    """``parameter`` with a value for each record: the refit on ``split``, whose records give the weights."""

    parameter: str
    split: Split
    refit: Refit | None
    comparison: Comparison | None = None
    fitted_gain: float = 0.0
    p_adjusted: float = 1.0
    status: str = UNTRIED
    reason: str = ""

    @property
    def gain(self) -> float:
        """Relative decrease of the held-out loss; minus infinity without a refit."""
        return self.comparison.gain if self.comparison else -math.inf


def by_recording(found: Search, context: Context) -> tuple[DifferingParameter, ...]:
    """The parameters of the last model of ``found`` that differ by recording, then those that explain as much
    in the place of an accepted effect, then those that were tried and do not, the largest gain first.

    Raises:
        ValueError: if there are fewer than two records, or a record is held out as a whole.
    """
    check_split(context.split)
    rules = context.rules
    kept, left, sharp = _one_after_another(found, context)
    named, told = [_entry(one, alike, sharp) for one, alike in kept], [one for one, _ in kept]
    gauge, alike, others = _of_gauges(found, context)
    last = told[-1].refit if told else None  # by the numerics of the gauges
    as_good = gauge is not None and (last is None or _no_worse(gauge.refit, last, rules))
    one_for_one = gauge is not None and len(told) == 1 and _no_worse(last, gauge.refit, rules)
    if gauge and as_good and not one_for_one:
        instead = [one.parameter for one in told if _no_worse(last, gauge.refit, rules)]
        named = [_entry(gauge, (*alike, *instead))]
        left += _outdone(told, f"{gauge.parameter} alone explains as much")
    elif gauge:
        others.append(gauge)
        if as_good:  # one parameter of the machine is told before a gauge that explains as much
            named = [_entry(told[0], (*kept[0][1], gauge.parameter), sharp)]
    others = _outdone(others, "another one explains as much, or more")
    tried = sorted((*left, *others), key=lambda one: -one.gain)
    return (*named, *_in_place(found, context), *map(_entry, tried))


def _outdone(trials: Sequence[Differing], reason: str) -> list[Differing]:
    """``trials``; those that passed do not differ, for that ``reason``."""
    return [replace(one, status=REJECTED, reason=reason) if one.status == PASSED else one for one in trials]


def _one_after_another(
    found: Search, context: Context
) -> tuple[list[tuple[Differing, tuple[str, ...]]], list[Differing], Refit | None]:
    """The parameters of the last model of ``found`` that differ by recording, each beside those before it and
    with what the records cannot tell from it; what was tried beside all of them, and does not; and the model
    with all of them, None if there are none. The smoothing of sign(v) is as narrow as pays beside them."""
    rules, base, split = context.rules, found.final, context.split
    kept: list[tuple[Differing, tuple[str, ...]]] = []
    while True:
        trials = _tried([(name, base, split) for name, base in _parameters(base)], base, context)
        passed = [one for one in trials if one.status == PASSED]
        if not passed or len(kept) >= rules.most_effects:
            return kept, trials, base if kept else None
        best = max(passed, key=lambda one: one.gain)
        assert best.refit is not None
        kept.append((best, _alike(best, passed, None if kept else found, rules)))
        context.say(f"{best.parameter} differs by recording: {best.gain:.1%} off the held-out error")
        split = best.split
        base = sharp_enough(best.refit, replace(context, split=split))


def _of_gauges(found: Search, context: Context) -> tuple[Differing | None, tuple[str, ...], list[Differing]]:
    """The gauge of the last model of ``found`` whose error by recording explains most, if any does, with what
    the records cannot tell from it; and the others that were tried."""
    final = found.final
    trials = _tried([(name, base, context.split) for name, base in _gauges(final)], final, context)
    passed = [one for one in trials if one.status == PASSED]
    if not passed:
        return None, (), trials
    best = max(passed, key=lambda one: one.gain)
    return best, _alike(best, passed, found, context.rules), [one for one in trials if one is not best]


def _tried(places: Sequence[tuple[str, Refit, Split]], base: Refit, context: Context) -> list[Differing]:
    """Each of ``places``, arguments of ``differing``, tried and judged beside ``base``."""
    trials = context.each("by recording", differing, places, lambda one: one.parameter)
    split = places[0][2] if places else context.split
    return _lasting(_judged(trials, context.rules), base, replace(context, split=split))


def check_split(split: Split) -> None:
    """Check that each of several records has horizons to fit and horizons to judge by.

    Raises:
        ValueError: if not.
    """
    if not split.gap or len(split.records) < 2:
        raise ValueError(
            "what differs by recording is judged on alternate horizons of two records or more, not "
            f"{split.described}"
        )


def _parameters(base: Refit) -> Iterator[tuple[str, Refit]]:
    """The free parameters of the model of ``base`` that have one value, by their names, with ``base``."""
    return ((p.name, base) for p in base.model.free if not _has_groups(p.name, base.model))


def _gauges(base: Refit) -> Iterator[tuple[str, Refit]]:
    """The relative error of each gauge, by its name, with ``base`` that has it in its model: zero."""
    for gauge in gauges(base.model):
        values = {**base.values, error_of(gauge): 0.0}
        yield error_of(gauge), replace(base, model=gauge.added_to(base.model), values=values)


@np.errstate(over="ignore", invalid="ignore")  # a start may diverge
def differing(name: str, base: Refit, split: Split, without: str = "") -> Differing:
    """``base`` with parameter ``name`` by record, and without the term ``without``, refitted and compared.
    That of a gauge is known in the first record: zero."""
    records = tuple(record.name for record in split.records)
    known = {of_group(name, records[0]): {"fixed": 0.0}} if is_error_of_gauge(name) else {}
    grouped = replace(
        base.model,
        groups={**base.model.groups, name: records},
        adjustments={**base.model.adjustments, **known},
    )
    split = replace(split, records=tuple(_weighted(split, name, k) for k in range(len(records))))
    own = {of_group(name, record): base.values[name] for record in records}
    values = {**{key: value for key, value in base.values.items() if key != name}, **own}
    before = replace(base, model=grouped, values=values)  # the same solution
    model = grouped.without(without) if without else grouped
    start = values_without(before, without) if without else values
    try:
        found = refit(model, split, [start], before, base.numerics, CONTINUATION)
    except (ValueError, *FAILURES) as error:
        return Differing(name, split, None, reason=f"could not be fitted: {error}")
    if not math.isfinite(found.cost):
        return Differing(name, split, None, reason="could not be fitted: the simulation diverges")
    fitted_gain = max(0.0, 1.0 - found.cost / base.cost) if base.cost > 0 else 0.0
    return Differing(name, split, found, compare(base.score, found.score), fitted_gain)


def _weighted(split: Split, name: str, k: int) -> Record:
    weights = {of_group(name, other.name): float(j == k) for j, other in enumerate(split.records)}
    return split.records[k].with_constants(weights, dict.fromkeys(weights, WEIGHT))


def _has_groups(name: str, model: Model) -> bool:
    return any(name in model.names_of(one) for one in model.groups)


def _judged(trials: Sequence[Differing], rules: Rules) -> list[Differing]:
    p_values = [one.comparison.p_value if one.comparison else 1.0 for one in trials]
    adjusted = holm(p_values, [one.fitted_gain for one in trials])
    return [_decided(replace(one, p_adjusted=p), rules) for one, p in zip(trials, adjusted, strict=True)]


def _decided(one: Differing, rules: Rules) -> Differing:
    if one.refit is None:
        return one
    if one.gain < rules.worth:
        return replace(one, status=REJECTED, reason=too_little(one.gain, rules))
    if one.p_adjusted > rules.alpha:
        reason = f"not significant: adjusted p = {one.p_adjusted:.2g} over {rules.alpha:g}"
        return replace(one, status=REJECTED, reason=reason)
    p_value = _same(one, one.refit)
    if not p_value <= rules.alpha:
        reason = f"its values do not differ by more than their errors: p = {p_value:.2g} that they are one"
        return replace(one, status=UNIDENTIFIABLE, reason=reason)
    reason = f"held-out RMSE {one.gain:.1%} lower, adjusted p = {one.p_adjusted:.2g}"
    return replace(one, status=PASSED, reason=reason)


def _lasting(trials: Sequence[Differing], base: Refit, context: Context) -> list[Differing]:
    """The ``trials`` beside ``base``; those that passed and do not survive other numerics are withdrawn."""
    passed = [one for one in trials if one.refit is not None and one.status == PASSED]
    if not passed:
        return list(trials)
    varied = variations(context.split.records, base.numerics, base.model.smooths)
    poorer = refitted_under(base, varied, context)
    reasons = {}
    for one in passed:
        given = [
            (base, one.refit, "", one.split, how, context.rules, other)
            for how, other in zip(varied, poorer, strict=True)
        ]
        reasons[one.parameter] = objection(tuple(context.mapper(survival, given)))
    return [
        replace(one, status=REJECTED, reason=f"withdrawn: {reasons[one.parameter]}")
        if reasons.get(one.parameter)
        else one
        for one in trials
    ]


def _same(one: Differing, found: Refit) -> float:
    """The p-value of one value in all records, by the standard errors of the refit."""
    names = found.model.names_of(one.parameter)
    free = [k for k, name in enumerate(names) if name in found.std]
    rows = [list(found.std).index(names[k]) for k in free]
    std = np.array([found.std[names[k]] for k in free])
    covariance = np.zeros((len(names), len(names)))
    covariance[np.ix_(free, free)] = found.correlation[np.ix_(rows, rows)] * np.outer(std, std)
    return chi_square_test([np.array([found.values[name] for name in names])], covariance).p_value


def _alike(
    best: Differing, passed: Sequence[Differing], found: Search | None, rules: Rules
) -> tuple[str, ...]:
    """The other parameters by recording, and beside the last model of ``found`` the effects, that explain as
    much as ``best``."""
    refits = {one.parameter: one.refit for one in passed if one is not best}
    last = found.steps[-1] if found and found.steps and found.steps[-1].accepted is None else None
    if last is not None:
        refits |= {t.candidate.name: t.refit for t in last.trials if t.gain >= rules.worth}
    return tuple(name for name, refit in refits.items() if _no_worse(refit, best.refit, rules))


def _no_worse(other: Refit | None, best: Refit | None, rules: Rules) -> bool:
    """Whether held-out horizons show no relevant advantage of ``best`` over ``other``."""
    if other is None or best is None:
        return False
    advantage = compare(other.score, best.score)
    return advantage.gain < rules.tie or advantage.p_value > rules.alpha


def _in_place(found: Search, context: Context) -> list[DifferingParameter]:
    """Parameters by recording that explain as much as the last model, or more, without one of its accepted
    effects. The p-value of more counts all that were tried."""
    final, rules = found.final, context.rules
    places = [
        (name, base, context.split, one.name)
        for one in found.accepted
        for name, base in (*_parameters(final), *_gauges(final))
        if not name.startswith(f"{one.name}.")
    ]
    trials = context.each("by recording, in place of effects", differing, places, lambda one: one.parameter)
    kept = []
    for one, (_, _, _, effect) in zip(trials, places, strict=True):
        if _no_worse(one.refit, final, rules):
            p_value = min(1.0, len(places) * one.comparison.p_value) if one.comparison else 1.0
            how = "more than" if rules.passes(one.gain, p_value) else "as much as"
            entry = _entry(replace(one, status=PASSED, p_adjusted=p_value, reason=f"explains {how} {effect}"))
            kept.append(replace(entry, in_place_of=effect))
    return sorted(kept, key=lambda one: -one.gain)


def _entry(one: Differing, alike: tuple[str, ...] = (), last: Refit | None = None) -> DifferingParameter:
    """``one`` as it is told, with its values in the model ``last`` (None: in its own)."""
    found = last or one.refit
    rmse = found.score.rmse.tolist() if found else ()
    outputs = [y.name for y in found.model.outputs] if found else ()
    units = {p.name: p.unit for p in found.model.parameters} if found else {}
    names = {r.name: of_group(one.parameter, r.name) for r in one.split.records} if found else {}
    known = 0.0 if is_error_of_gauge(one.parameter) and found and found.std else math.nan
    return DifferingParameter(
        parameter=one.parameter,
        status=one.status,
        reason=one.reason,
        gain=one.gain if found else -1.0,
        p_value=one.p_adjusted,
        values={
            record: Value(found.values[name], found.std.get(name, known), units[name])
            for record, name in names.items()
            if found
        },
        held_out_rmse=dict(zip(outputs, rmse, strict=True)),
        alike=alike,
    )
