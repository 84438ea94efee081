"""A strong ripple bends the whole fit over long horizons; over short ones it shows its pitch."""

from __future__ import annotations

import pytest

from hybridid.effects.library import effect_named
from hybridid.trace.candidates import Candidate
from hybridid.trace.refit import CONTINUATION, refit
from hybridid.trace.shorter import from_shorter, same_valley
from hybridid.trace.split import Split, by_blocks, by_record
from hybridid.trace.trial import attempt

LONG = 200  # samples, 1 s
RIPPLE = Candidate(effect_named("cogging"), "carriage")


@pytest.fixture(scope="module")
def strong(make_model, two_records):
    """The symmetric model over horizons of 1 s, fitted to a carriage with a cogging of half its drive."""
    first, second = two_records(ripple=40.0, pitch=0.01)
    split = by_record([first], [second], LONG)
    return split, refit(make_model(), split, factors=CONTINUATION)


def test_the_ripple_is_found_that_long_horizons_hide(strong, monkeypatch):
    split, base = strong
    found = attempt(RIPPLE, base, split)
    assert found.gain > 0.99
    assert found.own("values")["pitch"] == pytest.approx(0.01, rel=1e-4)
    monkeypatch.setattr("hybridid.trace.trial.from_shorter", lambda *given: None)
    assert attempt(RIPPLE, base, split).gain < 0.1


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


@pytest.mark.parametrize(("name", "samples"), [("asymmetric_viscous", LONG), ("cogging", 50)])
def test_no_start_where_nothing_is_sought_or_horizons_are_short(strong, name, samples):
    split, base = strong
    candidate = Candidate(effect_named(name), "carriage")
    model = candidate.added_to(base.model)
    assert (
        from_shorter(candidate, model, base, by_record(split.records[:1], split.records[1:], samples)) is None
    )


@pytest.mark.parametrize(("pitch", "same"), [(0.0101, True), (0.0105, False)])
def test_values_are_of_one_valley_if_the_pitch_is_the_same(pitch, same):
    one, other = (
        {"carriage.cogging.pitch": p, "carriage.cogging.A_s": a} for p, a in ((0.01, 1), (pitch, 9))
    )
    assert same_valley(RIPPLE, one, other) is same
