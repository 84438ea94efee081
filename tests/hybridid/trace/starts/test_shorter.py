"""A strong ripple bends the whole fit over long horizons; over short ones it shows its pitch."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from hybridid.effects.library import effect_named
from hybridid.effects.over import Over
from hybridid.simulation import simulate
from hybridid.simulation.windows import cut
from hybridid.trace.candidates import Candidate
from hybridid.trace.horizons.split import Split, by_blocks, by_record
from hybridid.trace.learned.ceiling import ceiling
from hybridid.trace.learned.learned_effort import with_learned_effort
from hybridid.trace.ports.path import Path
from hybridid.trace.refits.refit import CONTINUATION, refit
from hybridid.trace.starts.shorter import (
    from_shorter,
    learned_from_shorter,
    same_valley,
    strays,
    with_shorter,
)
from hybridid.trace.trials.trial import _begun_anew, _unless_better_from_shorter, attempt

LONG = 200  # samples, 1 s
RIPPLE = Candidate(effect_named("cogging"), "carriage")


@pytest.fixture(scope="module", params=[0.01, 0.02])
def strong(request, make_model, two_records):
    """The symmetric model over horizons of 1 s, fitted to a carriage with a cogging of half its drive."""
    first, second = two_records(ripple=40.0, pitch=request.param)
    split = by_record([first], [second], LONG)
    return split, with_shorter(refit(make_model(), split, factors=CONTINUATION), split)


def test_the_ripple_is_found_that_long_horizons_hide(strong, request, monkeypatch):
    split, base = strong
    found = attempt(RIPPLE, base, split)
    assert found.gain > 0.99
    assert found.own("values")["pitch"] == pytest.approx(request.node.callspec.params["strong"], rel=1e-4)
    monkeypatch.setattr("hybridid.trace.trials.trial.from_shorter", lambda *given: None)
    assert attempt(RIPPLE, base, split).gain < 0.1


def test_a_poorer_model_in_a_false_minimum_is_fitted_anew_from_shorter_horizons(make_model, two_records):
    """A cylinder's fit over 1 s had ended at nine times its mass: over 0.1 s it does not."""
    split = by_record(*([one] for one in two_records()), LONG)
    base = refit(make_model(), split, factors=CONTINUATION)
    trapped = replace(base, values={**base.values, "M": 9 * base.values["M"]}, cost=10 * base.cost)
    freed = with_shorter(trapped, split)
    assert freed.values["M"] == pytest.approx(base.values["M"], rel=1e-3)
    assert freed.cost == pytest.approx(base.cost, rel=1e-3)
    assert with_shorter(base, split) is base


def test_a_fit_that_ends_elsewhere_from_shorter_horizons_has_two_minima(make_model, two_records):
    """As if nine times the mass left even less over 1 s: the fit from shorter horizons does not go there."""
    split = by_record(*([one] for one in two_records()), LONG)
    base = refit(make_model(), split, factors=CONTINUATION)
    lower = replace(base, values={**base.values, "M": 9 * base.values["M"]}, cost=base.cost / 10)
    forked = with_shorter(lower, split)
    assert forked.two_minima
    assert forked.values == lower.values
    assert forked.shorter.values["M"] == pytest.approx(base.values["M"], rel=1e-2)
    assert not with_shorter(base, split).two_minima


def test_a_learned_effort_begins_there_too(make_model, two_records):
    """Friction that differs by direction, seen from nine times the mass, as if that left less."""
    split = by_record(*([one] for one in two_records(df_v=80.0)), LONG)
    base = refit(make_model(), split, factors=CONTINUATION)
    lower = replace(base, values={**base.values, "M": 9 * base.values["M"]}, cost=base.cost / 1.1)
    forked = with_shorter(lower, split)
    model, starts = with_learned_effort(
        forked, Path.of(base, split, split.fitted), "carriage", Over("velocity")
    )
    values, _ = learned_from_shorter(model, starts, forked, split)
    assert values["M"] == pytest.approx(95.0, rel=0.05)
    assert learned_from_shorter(model, starts, replace(forked, two_minima=False), split) is None
    with_it, without = (
        ceiling(one, split, "carriage", Over("velocity")).refit
        for one in (forked, replace(forked, two_minima=False))
    )
    assert with_it.values["M"] == pytest.approx(95.0, rel=0.01)
    assert with_it.cost < without.cost / 1000


def test_what_takes_its_share_may_be_in_a_false_minimum_all_the_same(strong, monkeypatch):
    """Where the path strays, the start from shorter horizons is tried however much an effect takes."""
    split, base = strong
    asked = []
    monkeypatch.setattr("hybridid.trace.trials.trial.from_shorter", lambda *given: asked.append(given))
    drag = Candidate(effect_named("quadratic_drag"), "carriage")
    taking = replace(base, model=drag.added_to(base.model), score=halved(base.score))
    assert strays(base)
    assert _unless_better_from_shorter(taking, drag, base, split, 0.02) is taking
    assert len(asked) == 1


def halved(score):
    """The score of half the error."""
    return replace(score, squares=score.squares / 4)


def test_a_resonance_is_sought_over_short_horizons_though_the_fit_is_the_same(make_model, two_records):
    """A load of a fifth of the mass, behind a spring: the fit without it bends at neither length."""
    mode, model = Candidate(effect_named("flexible_mode"), "carriage"), make_model()
    truth = {"M": 75.0, "carriage.viscous.f_v": 200.0, "carriage.coulomb.f_c": 20.0}
    truth |= {f"{mode.name}.{name}": v for name, v in {"m_l": 15.0, "frequency": 15.0, "zeta": 0.03}.items()}
    with_mode = mode.added_to(model)
    full = with_mode.values({**{p.name: p.guess for p in with_mode.parameters}, **truth})
    values = dict(zip((p.name for p in with_mode.parameters), full, strict=True))
    records = [
        replace(r, outputs=simulate(with_mode, values, r, np.zeros(len(with_mode.states)), 4).outputs)
        for r in two_records()
    ]
    split = by_record(records[:1], records[1:], LONG)
    base = replace(refit(model, split, factors=CONTINUATION), shorter=None)
    found, _ = from_shorter(mode, with_mode, base, split)
    assert found[f"{mode.name}.frequency"] == pytest.approx(15.0, rel=0.05)
    drag = Candidate(effect_named("quadratic_drag"), "carriage")
    assert from_shorter(drag, drag.added_to(model), base, split) is None


def test_short_horizons_lie_in_the_long_ones(two_records):
    first, second = two_records()
    split = by_blocks([first, second], LONG)
    shorter = split.shorter(20)
    assert isinstance(shorter, Split)
    assert shorter.horizon == 20
    assert shorter.gap == 0
    assert not set(shorter.fitted) & set(shorter.held_out)
    assert shorter.fitted[:10] == (0, 1, 2, 3, 4, 5, 6, 7, 8, 20)  # the tenth holds the gap
    assert shorter.held_out[:9] == tuple(range(10, 19))


def test_pieces_across_the_ends_of_fitted_horizons_are_fitted(two_records):
    """Horizons of 45 samples, pieces of 4: no sample is left out, so inner states are handed on."""
    first, second = two_records()
    split = by_record([first], [second], 45)
    shorter = split.shorter(4)
    pieces = cut(split.records, 4, 1)
    assert len(shorter.fitted) == sum(record == 0 for record, _, _ in pieces.origin)
    assert pieces.select(shorter.fitted).complete


def test_the_fitted_records_alone_keep_what_is_fitted(two_records):
    first, second = two_records()
    alone = by_record([first], [second], 40).swapped.fitted_alone  # the second record is fitted
    assert alone.records == (second,)
    assert alone.fitted == alone.held_out == tuple(range(len(cut([second], 40, 1).origin)))
    blocks = by_blocks([first, second], 40)
    assert blocks.fitted_alone.records == blocks.records
    assert blocks.fitted_alone.fitted == blocks.fitted


def test_over_short_horizons_another_fit_results_where_much_is_missing(strong):
    _, base = strong
    assert base.shorter.values["M"] != pytest.approx(base.values["M"], rel=0.1)


def test_where_nothing_is_missing_they_show_nothing_else(make_model, split_of):
    split = split_of()
    long = by_record(split.records[:1], split.records[1:], LONG)
    assert with_shorter(refit(make_model(), long), long).shorter is None


def test_horizons_that_are_too_short_are_not_divided(strong):
    split, base = strong
    short = by_record(split.records[:1], split.records[1:], 50)
    assert with_shorter(replace(base, shorter=None), short).shorter is None


def test_no_start_for_an_effect_that_explains_nothing_over_short_horizons(strong):
    split, base = strong
    candidate = Candidate(effect_named("friction_drift"), "carriage")
    assert from_shorter(candidate, candidate.added_to(base.model), base, split) is None


def test_a_start_for_an_effect_that_seeks_nothing_where_much_is_missing(make_model, two_records):
    """Viscous friction as strong as the drive: over 1 s the model without it follows another motion."""
    first, second = two_records()
    split, drag = by_record([first], [second], LONG), Candidate(effect_named("viscous"), "carriage")
    base = with_shorter(refit(make_model(("coulomb", "offset")), split), split)
    values, begun = from_shorter(drag, drag.added_to(base.model), base, split)
    over_long = attempt(drag, base, split).own("values")["f_v"]
    assert values["carriage.viscous.f_v"] == pytest.approx(over_long, rel=0.05)
    assert begun.x0.shape == base.x0.shape


@pytest.mark.parametrize(("pitch", "same"), [(0.0101, True), (0.0105, False)])
def test_values_are_of_one_valley_if_the_pitch_is_the_same(pitch, same):
    one, other = (
        {"carriage.cogging.pitch": p, "carriage.cogging.A_s": a} for p, a in ((0.01, 1), (pitch, 9))
    )
    assert same_valley(RIPPLE, one, other) is same


@pytest.mark.parametrize(("level", "same"), [(10.1, True), (12.0, False)])
def test_values_of_an_effect_that_seeks_nothing_are_of_one_valley_if_all_are_the_same(level, same):
    candidate = Candidate(effect_named("coulomb"), "carriage")
    one, other = ({"carriage.coulomb.f_c": value} for value in (10.0, level))
    assert same_valley(candidate, one, other) is same


def test_a_trial_that_diverges_held_out_begins_anew_where_the_record_is(strong):
    """As if the initial states that the base lends had led the right model astray."""
    split, base = strong
    found = attempt(RIPPLE, base, split).refit
    assert _begun_anew(found, base, split) is found
    lost = replace(found, score=replace(found.score, squares=np.full_like(found.score.squares, np.nan)))
    again = _begun_anew(lost, base, split)
    assert again.score.loss == pytest.approx(found.score.loss, rel=0.01)


def test_an_effect_that_seeks_nothing_does_not_start_there_where_the_path_stays(
    make_model, split_of, monkeypatch
):
    """A model that is bent, as its offset is uncertain, but whose path stays within 1 % of the motion."""
    asked = []
    monkeypatch.setattr(
        "hybridid.trace.trials.trial.from_shorter", lambda candidate, *given: asked.append(candidate.name)
    )
    split = split_of()
    long = by_record(split.records[:1], split.records[1:], LONG)
    base = refit(make_model(), long)
    for name in ("friction_drift", "cogging"):
        attempt(Candidate(effect_named(name), "carriage"), replace(base, shorter=base), long)
    assert strays(base) is False
    assert asked == ["carriage.cogging"]
    drift, forked = Candidate(effect_named("friction_drift"), "carriage"), replace(base, shorter=base)
    attempt(drift, replace(forked, two_minima=True), long)
    assert asked[1:] == ["carriage.friction_drift"]
