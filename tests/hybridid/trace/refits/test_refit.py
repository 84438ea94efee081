"""A refit is data and settings: another method descends to the same."""

from __future__ import annotations

from dataclasses import replace

import pytest

from hybridid.effects.library import effect_named
from hybridid.estimators.ipopt import Ipopt
from hybridid.estimators.method import Method
from hybridid.estimators.multiple_shooting import MultipleShooting
from hybridid.trace.candidates import Candidate
from hybridid.trace.refits.numerics import Numerics
from hybridid.trace.refits.refit import CONTINUATION, refit, refit_beside


def test_multiple_shooting_refits_to_the_same_score(make_model, split_of):
    split = split_of()
    thesis = Numerics(method=Method(MultipleShooting(25), Ipopt()))
    fast, slow = (refit(make_model(), split, numerics=one, tolerance=1e-8) for one in (Numerics(), thesis))
    assert slow.converged
    assert slow.cost == pytest.approx(fast.cost, rel=1e-5)
    assert slow.score.loss == pytest.approx(fast.score.loss, rel=1e-3)
    assert slow.cost != fast.cost, "another method was used"


def test_a_refit_that_promises_little_ends_early_without_standard_errors(make_model, split_of):
    model, split = make_model(), split_of()
    starts = [{}, {"M": 70.0}]
    whole = refit(model, split, starts)
    early = refit(model, split, starts, hopeful=0.5 * whole.cost)
    assert early.ended_early
    assert not early.std
    assert early.score.loss == pytest.approx(whole.score.loss, rel=0.01)
    assert not refit(model, split, starts, hopeful=1.01 * whole.cost).ended_early
    surprise = refit(model, split, starts, hopeful=0.5 * whole.cost, surprising=1.1 * early.score.loss)
    assert not surprise.ended_early
    assert surprise.values == whole.values
    assert surprise.std == whole.std


def test_a_trial_that_takes_less_than_it_was_asked_for_has_standard_errors_all_the_same(make_model, split_of):
    """It may be worth having, and is judged by them."""
    split = split_of()
    base = refit(make_model(("viscous",)), split)
    richer = make_model(("viscous", "coulomb"))
    easy = replace(base, cost=1e6 * base.cost)
    found = refit_beside(base, richer, split, [{}], base.numerics, easy, least=0.9999)
    assert found.score.loss < 0.95 * base.score.loss
    assert found.score.loss > (1 - 0.9999) * base.score.loss
    assert found.std


def test_a_trial_keeps_what_the_model_without_it_explains(make_model, split_of):
    """At ten times its width, sign(v) leaves far more than the noise: a descent there fits that error."""
    split, numerics = split_of(), Numerics(smoothing=0.2)
    base = refit(make_model(), split, numerics=numerics, factors=CONTINUATION)
    for effect in ("quadratic_drag", "stribeck", "position_friction"):
        richer = base.model.plus(effect_named(effect))
        starts = Candidate(effect_named(effect), "carriage").starts(richer, base.values)
        found = refit_beside(base, richer, split, starts, numerics, base, least=0.02)
        assert found.cost <= (1 + 1e-9) * base.cost
