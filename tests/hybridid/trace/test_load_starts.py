"""A load begins with half of the inertia that the model without it has found."""

from __future__ import annotations

from dataclasses import replace

import pytest

from hybridid.effects.library import effect_named
from hybridid.trace.candidates import Candidate
from hybridid.trace.load_starts import with_closed_contact, with_half_the_inertia
from hybridid.trace.refit import refit
from hybridid.trace.sought import sought


@pytest.fixture(scope="module")
def fitted(make_model, split_of):
    split = split_of()
    return refit(make_model(), split), split


def test_the_machine_gives_half_of_its_inertia_away(fitted):
    base, split = fitted
    mode = Candidate(effect_named("flexible_mode"), "carriage")
    (start,) = with_half_the_inertia(mode, [{**base.values, f"{mode.name}.frequency": 5.0}], base, split)
    half = base.values["M"] / 2
    assert start["M"] == pytest.approx(half, rel=1e-3)
    assert start[f"{mode.name}.m_l"] == pytest.approx(half, rel=1e-3)
    assert start[f"{mode.name}.frequency"] == 5.0
    assert start["carriage.viscous.f_v"] == base.values["carriage.viscous.f_v"]


def test_it_is_among_the_starts_of_a_load_and_of_no_other_effect(fitted):
    base, split = fitted

    def masses(name):
        candidate = Candidate(effect_named(name), "carriage")
        found = sought(candidate, candidate.added_to(base.model), base, split)
        return {round(start["M"] / base.values["M"], 2) for start in found}

    assert masses("flexible_mode") == {0.5, 1.0}
    assert masses("backlash") == {0.83, 0.67, 0.5}
    assert masses("cogging") == {1.0}


def test_a_load_behind_a_play_begins_with_its_contact_closed(fitted):
    base, split = fitted
    play = Candidate(effect_named("backlash"), "carriage")
    starts = with_closed_contact(play, play.added_to(base.model), base, split)
    assert len(starts) == 3
    for start in starts:
        assert start["M"] + start[f"{play.name}.m_l"] == pytest.approx(base.values["M"], rel=1e-3)
        assert start[f"{play.name}.g"] == pytest.approx(base.score.rmse[0])
        assert start[f"{play.name}.frequency"] == pytest.approx(0.2 / split.records[0].dt)


def test_no_other_effect_begins_with_a_contact_closed(fitted):
    base, split = fitted
    mode = Candidate(effect_named("flexible_mode"), "carriage")
    assert with_closed_contact(mode, mode.added_to(base.model), base, split) == []


def test_a_mass_that_is_known_gives_nothing_away(make_model, split_of):
    split = split_of()
    model = make_model()
    known = refit(replace(model, adjustments={**model.adjustments, "M": {"fixed": 80.0}}), split)
    mode = Candidate(effect_named("flexible_mode"), "carriage")
    assert with_half_the_inertia(mode, [dict(known.values)], known, split) == []
