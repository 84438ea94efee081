"""Beside a model that leaves the noise, a score test chooses the learned efforts. All records: simulated."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest

from hybridid.effects.over import Over
from hybridid.trace.context import Context
from hybridid.trace.learned import promising_efforts
from hybridid.trace.learned.ceiling import ceiling, ceilings, strongest
from hybridid.trace.learned.promising_efforts import ALWAYS, most_promising, promised, promising
from hybridid.trace.refits.refit import refit

PLACES = [("carriage", Over(one)) for one in ("velocity", "position", "time")] + [
    ("carriage", Over("position", "velocity"))
]


@pytest.fixture(scope="module")
def slight(make_model, split_of):
    """An asymmetric friction that takes hardly more than the noise."""
    split = split_of(df_v=1.0)
    return split, refit(make_model(), split)


def test_one_step_promises_what_a_fit_takes_of_a_slight_effect(slight):
    split, base = slight
    place = PLACES[0]
    found = ceiling(base, split, *place, 0.0).refit
    amplitudes = len(found.model.free) - len(base.model.free)
    by_chance = amplitudes / found.problem(split).on(split.fitted).windows.samples
    taken = 1.0 - found.cost / base.cost
    assert promised(base, split, *place) == pytest.approx(taken - by_chance, rel=0.2)
    assert taken > 2 * by_chance


def test_what_promises_little_is_not_fitted_but_for_the_best(make_model, split_of):
    split = split_of()
    base, context = refit(make_model(), split), Context(split)
    shares = [promised(base, split, *place) for place in PLACES]
    assert max(shares) < 0.01, "only noise is left"
    chosen = promising(PLACES, base, context, 0.01)
    least = min(range(len(PLACES)), key=lambda k: shares[k])
    assert chosen == [place for k, place in enumerate(PLACES) if k != least]
    assert len(chosen) == ALWAYS
    assert promising(PLACES, base, context, -1.0) == PLACES
    few = replace(context, variables=("velocity", "position"))
    found = ceilings(base, few, promised=math.inf)
    assert sum(bool(one.curve) for one in found) == ALWAYS
    assert [one.place for one in found] == [one.place for one in ceilings(base, few)]
    left_out = [one for one in found if not one.fitted]
    assert len(left_out) == len(found) - ALWAYS
    assert all(one.refit.ended_early and one.gain == 0.0 and one.p_value == 1.0 for one in left_out)
    assert strongest(found).fitted


def test_the_most_promising_efforts_promise_half_of_the_best(make_model, split_of, monkeypatch):
    """And as few as ``ALWAYS`` in any case. What cannot be simulated is among them, and is no measure."""
    split = split_of()
    base, context = refit(make_model(), split), Context(split)
    monkeypatch.setattr(promising_efforts, "ALWAYS", 1)
    for shares, chosen in {
        (0.4, 0.1, 0.2, 0.0): [0, 2],
        (0.4, math.inf, 0.1, 0.0): [0, 1],
        (-0.2, -0.3, -0.1, -0.4): [2],
    }.items():
        by_place = dict(zip(PLACES, shares, strict=True))
        monkeypatch.setattr(promising_efforts, "promised", lambda b, s, *place, of=by_place: of[place])
        assert most_promising(PLACES, base, context) == [PLACES[k] for k in chosen]


def test_what_cannot_be_simulated_is_fitted(slight, monkeypatch):
    """Then the fit tells why."""
    split, base = slight
    begun = "hybridid.trace.learned.promising_efforts.problem_of"

    def too_stiff(*given):
        raise ValueError

    monkeypatch.setattr(begun, too_stiff)
    assert promised(base, split, *PLACES[0]) == float("inf")
