"""A load begins with half of the inertia that the model without it has found."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from hybridid.effects.library import effect_named
from hybridid.simulation import simulate
from hybridid.trace.candidates import Candidate
from hybridid.trace.horizons.split import by_record
from hybridid.trace.refits.refit import CONTINUATION, refit
from hybridid.trace.starts.load_starts import with_closed_contact, with_half_the_inertia
from hybridid.trace.starts.sought import sought
from hybridid.trace.trials.trial import attempt


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
    assert masses("backlash") == {0.83, 0.67, 0.5, 1.0}
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


def test_a_soft_contact_is_found_by_its_resonance(make_model, two_records):
    """A load that hangs on a spring of 4 Hz, with a play: the stiff contacts lead to other minima."""
    play, model = Candidate(effect_named("backlash"), "carriage"), make_model()
    truth = {"M": 75.0, "carriage.viscous.f_v": 200.0, "carriage.coulomb.f_c": 20.0}
    own = {"m_l": 5.0, "g": 2e-4, "frequency": 4.0, "zeta": 0.05}
    truth |= {f"{play.name}.{name}": value for name, value in own.items()}
    hidden = play.added_to(model)
    values = {p.name: p.guess for p in hidden.parameters} | truth
    at_rest = np.zeros(len(hidden.states))
    records = [replace(r, outputs=simulate(hidden, values, r, at_rest, 8).outputs) for r in two_records()]
    split = by_record(records[:1], records[1:], 200)
    base = refit(model, split, factors=CONTINUATION)
    starts = sought(play, hidden, base, split)
    assert any(s[f"{play.name}.frequency"] == pytest.approx(4.0, rel=0.2) for s in starts)
    found = attempt(play, base, split).own("values")
    assert found["frequency"] == pytest.approx(4.0, rel=0.05)
    assert found["g"] == pytest.approx(2e-4, rel=0.2)


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
