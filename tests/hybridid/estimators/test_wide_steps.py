"""A descent at a wide smoothing takes as many steps as that needs, and leads to the same optimum."""

from __future__ import annotations

import numpy as np
import pytest

from hybridid.estimators import levenberg_marquardt
from hybridid.estimators.method import GAUSS_NEWTON
from hybridid.estimators.problem import build_problem
from hybridid.estimators.stop import Stop
from hybridid.estimators.wide_steps import MANY, in_wide_steps

STEPS = 24


def problem_of(model, record, steps=STEPS, integrator="rk4"):
    return build_problem(model, [record], 50, steps, integrator=integrator).without_ends(3)


@pytest.fixture
def sharp(make_model):
    """A carriage whose sign(v) is smoothed so narrowly that RK4 takes many steps a sample."""
    return make_model(adjust={"carriage.epsilon": {"guess": 2e-5}})


def test_it_takes_fewer_steps_over_the_same_samples(sharp, noisy):
    problem = problem_of(sharp, noisy).on([1, 3, 4])
    wide = in_wide_steps(problem, sharp.values(), 10.0)
    assert 1 <= wide.windows.substeps <= STEPS // 5
    assert wide.windows.origin == problem.windows.origin
    np.testing.assert_array_equal(wide.windows.cells, problem.windows.cells)
    np.testing.assert_array_equal(wide.windows.outputs, problem.windows.outputs)


def test_its_simulation_is_as_accurate(sharp, noisy):
    problem = problem_of(sharp, noisy)
    p = problem.smoothed(sharp.values(), 10.0)
    wide, x0 = in_wide_steps(problem, sharp.values(), 10.0), problem.measured_x0()
    fine, coarse = (one.cost(one.shot(x0, p, sensitivities=False)) for one in (problem, wide))
    assert coarse == pytest.approx(fine, rel=1e-3)


@pytest.mark.parametrize(
    ("steps", "integrator", "factor"), [(STEPS, "rk4", 1.0), (MANY, "rk4", 10.0), (STEPS, "rodas3", 10.0)]
)
def test_what_gains_nothing_stays_as_it_is(sharp, noisy, steps, integrator, factor):
    problem = problem_of(sharp, noisy, steps, integrator)
    assert in_wide_steps(problem, sharp.values(), factor) is problem


def test_the_descent_ends_where_it_does_in_short_steps(sharp, noisy, monkeypatch):
    problem, factors, stop = problem_of(sharp, noisy), (10.0, 3.0, 1.0), Stop(tolerance=1e-9)
    begun = sharp.values(), problem.measured_x0()
    quick = GAUSS_NEWTON.solve(problem, *begun, factors, stop)
    monkeypatch.setattr(levenberg_marquardt, "in_wide_steps", lambda problem, p, factor: problem)
    slow = GAUSS_NEWTON.solve(problem, *begun, factors, stop)
    assert quick.cost == pytest.approx(slow.cost, rel=1e-6)
    np.testing.assert_allclose(quick.p, slow.p, rtol=1e-3)
