"""What RK4 cannot solve the implicit integrator does: the declared model and learned efforts (simulated)."""

from __future__ import annotations

import pytest

from hybridid.effects.over import Over
from hybridid.simulation.stability import TooStiff
from hybridid.trace.learned import ceiling as ceiling_module
from hybridid.trace.learned.ceiling import ceiling
from hybridid.trace.refits.numerics import DECLARED
from hybridid.trace.refits.refit import refit
from hybridid.trace.starts import solve


@pytest.fixture
def stiff_for_rk4(monkeypatch):
    """As if the end of each refit were too stiff for RK4."""
    monkeypatch.setattr(solve, "_too_stiff", lambda found, split: found.numerics.integrator == "rk4")


def test_a_declared_model_too_stiff_for_rk4_goes_on_with_the_implicit_integrator(
    make_model, split_of, stiff_for_rk4
):
    split = split_of()
    found = solve.refit_declared(make_model(), split, [{}], DECLARED)
    assert found.numerics.integrator == "rodas3"
    assert found.score.loss == pytest.approx(refit(make_model(), split).score.loss, rel=0.05)


def test_it_stays_where_the_implicit_integrator_cannot_solve_it_either(
    make_model, split_of, stiff_for_rk4, monkeypatch
):
    def refuse(model, split, starts, before, numerics, factors):
        if numerics.integrator == "rodas3":
            raise TooStiff("needs more than 50 steps a sample")
        return refit(model, split, starts, before, numerics, factors)

    monkeypatch.setattr(solve, "refit", refuse)
    assert solve.refit_declared(make_model(), split_of(), [{}], DECLARED).numerics.integrator == "rk4"


def test_a_model_that_rk4_solves_is_not_refitted(make_model, split_of, monkeypatch):
    monkeypatch.setattr(solve, "_explains_more", lambda one, other: pytest.fail("no second refit was needed"))
    assert solve.refit_declared(make_model(), split_of(), [{}], DECLARED).numerics == DECLARED


def test_a_learned_effort_too_stiff_for_rk4_is_solved_implicitly(make_model, split_of, monkeypatch):
    made = ceiling_module.refit_if_hopeful

    def only_implicit(model, split, starts, before, numerics, *given, **options):
        if numerics.integrator == "rk4":
            raise TooStiff("needs more than 50 steps a sample")
        return made(model, split, starts, before, numerics, *given, **options)

    monkeypatch.setattr(ceiling_module, "refit_if_hopeful", only_implicit)
    split = split_of(df_v=75.0)
    found = ceiling(refit(make_model(), split), split, "carriage", Over("velocity"))
    assert found.failure == ""
    assert found.refit.numerics.integrator == "rodas3"
    assert found.gain > 0.3
