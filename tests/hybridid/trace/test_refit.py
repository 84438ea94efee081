"""A refit is data and settings: another method descends to the same."""

from __future__ import annotations

from dataclasses import replace

import pytest

from hybridid.effects.library import effect_named
from hybridid.estimators.ipopt import Ipopt
from hybridid.estimators.method import Method
from hybridid.estimators.multiple_shooting import MultipleShooting
from hybridid.simulation.stability import MOST
from hybridid.trace.candidates import Candidate
from hybridid.trace.numerics import Numerics
from hybridid.trace.refit import CONTINUATION, STIFF, _most, _room, refit, refit_beside


def test_multiple_shooting_refits_to_the_same_score(make_model, split_of):
    split = split_of()
    thesis = Numerics(method=Method(MultipleShooting(25), Ipopt()))
    fast, slow = (refit(make_model(), split, numerics=one, tolerance=1e-8) for one in (Numerics(), thesis))
    assert slow.converged
    assert slow.cost == pytest.approx(fast.cost, rel=1e-5)
    assert slow.score.loss == pytest.approx(fast.score.loss, rel=1e-3)
    assert slow.cost != fast.cost, "another method was used"


def test_a_start_that_is_left_out_as_too_stiff_is_told(make_model, split_of):
    """Dahl friction over a nanometre: RK4 would need hundreds of steps a sample there."""
    model, split = make_model(("viscous", "coulomb", "dahl")), split_of()
    mild = {"carriage.dahl.f_c": 1.0, "carriage.dahl.s": 1e-2}
    short = {"carriage.dahl.f_c": 20.0, "carriage.dahl.s": 1e-6}
    assert Numerics().steps(model, model.values(short), split) > STIFF
    assert refit(model, split, [mild]).unsolved == ()
    assert refit(model, split, [mild, short]).unsolved == (1,)


def test_only_what_an_effect_adds_to_the_steps_is_its_stiffness(make_model, split_of):
    base = refit(make_model(), split_of())
    assert _room(None) == _room(replace(base, substeps=2)) == STIFF
    assert _room(replace(base, substeps=10)) == 15
    finer = replace(base, substeps=20, numerics=replace(base.numerics, finer=2))
    assert _room(finer) == 15
    assert _most(None) == _most(base) == MOST
    assert _most(replace(base, substeps=MOST)) == 75, "what takes as many steps as its base is not refused"


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
