"""Initial states at known parameters: each horizon finds its own optimum."""

from __future__ import annotations

import numpy as np
import pytest

from hybridid.estimators.levenberg_marquardt import _descend
from hybridid.estimators.method import GAUSS_NEWTON
from hybridid.estimators.problem import build_problem
from hybridid.estimators.reduced import LeastSquares
from hybridid.estimators.separate import is_separate, solve_separately
from hybridid.estimators.stop import Stop


@pytest.fixture
def problem(carriage, make_model):
    return build_problem(make_model(("viscous", "coulomb")), [carriage.record(600)], 100, 2, free=())


def astray(problem):
    return problem.measured_x0() + np.random.default_rng(3).normal(size=(problem.windows.count, 2)) * [
        1e-3,
        0.05,
    ]


def test_the_optimum_of_all_horizons_together(problem):
    p, start, stop = problem.model.values(), astray(problem), Stop(100, 1e-9)
    variables = LeastSquares.of(problem)
    ours = solve_separately(variables, p, start, stop)
    theirs = _descend(variables, p, start, stop, lambda *_: None)
    assert ours.converged
    assert theirs.converged
    assert ours.cost <= theirs.cost * (1 + 1e-8)
    np.testing.assert_allclose(ours.x0, theirs.x0, rtol=1e-4, atol=1e-7)


def test_a_horizon_does_not_depend_on_the_others(problem):
    p, start, stop = problem.model.values(), astray(problem), Stop(100, 1e-9)
    whole = solve_separately(LeastSquares.of(problem), p, start, stop).x0
    alone = problem.on([2])
    found = solve_separately(LeastSquares.of(alone), p, start[[2]], stop).x0
    np.testing.assert_allclose(found[0], whole[2], rtol=1e-5, atol=1e-8)


def test_the_solver_takes_this_way_only_where_nothing_is_shared(problem, carriage, make_model):
    assert is_separate(problem)
    assert not is_separate(build_problem(make_model(("viscous",)), [carriage.record(300)], 100, 2))
    bristle = build_problem(make_model(("viscous", "dahl")), [carriage.record(300)], 100, 2, free=())
    assert not is_separate(bristle)


def test_known_initial_states_stay(problem, carriage, make_model):
    model = make_model(("viscous", "coulomb"))
    known = build_problem(model, [carriage.record(600)], 100, 2, estimate_x0=False, free=())
    start = astray(known)
    found = GAUSS_NEWTON.solve(known, model.values(), start)
    np.testing.assert_array_equal(found.x0, start)
    assert found.converged


def test_a_start_that_diverges_has_no_finite_cost(problem, make_model, carriage):
    model = make_model(("cubic_stiffness",))
    wild = build_problem(model, [carriage.record(100)], 50, 1, free=())
    p = model.values({"carriage.cubic_stiffness.k_3": -1e9})
    found = GAUSS_NEWTON.solve(wild, p, np.ones((wild.windows.count, 2)))
    assert found.cost == np.inf
    assert not found.converged
