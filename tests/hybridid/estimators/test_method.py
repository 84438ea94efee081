"""Transcription and solver are chosen apart: what fits together reaches one optimum, the rest is refused."""

from __future__ import annotations

import numpy as np
import pytest

from hybridid.estimators.ipopt import Ipopt
from hybridid.estimators.levenberg_marquardt import LevenbergMarquardt
from hybridid.estimators.method import GAUSS_NEWTON, Method
from hybridid.estimators.multiple_shooting import MultipleShooting
from hybridid.estimators.problem import build_problem
from hybridid.estimators.reduced import Reduced
from hybridid.estimators.stop import Stop
from hybridid.validation.predict import horizon_run


def test_least_squares_without_constraints_is_all_that_levenberg_marquardt_takes():
    with pytest.raises(ValueError, match="no constraints, and MultipleShooting has some: choose") as caught:
        Method(MultipleShooting(50), LevenbergMarquardt())
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("hessian", ["exact", "gauss_newton"])
def test_ipopt_solves_the_reduced_problem_too(symmetric, noisy, hessian):
    problem = build_problem(symmetric, [noisy], 50, 2)
    begun = symmetric.values(), problem.measured_x0()
    fast, slow = (
        method.solve(problem, *begun, stop=Stop(tolerance=1e-9))
        for method in (GAUSS_NEWTON, Method(Reduced(), Ipopt(hessian)))
    )
    assert fast.converged
    assert slow.converged
    assert slow.cost == pytest.approx(fast.cost, rel=1e-7)
    np.testing.assert_allclose(slow.p, fast.p, rtol=1e-4)
    np.testing.assert_allclose(slow.x0, fast.x0, atol=1e-6)


def test_initial_states_of_a_prediction_are_the_same_by_another_method(symmetric, noisy, free_run_fit):
    values = free_run_fit.values
    thesis = Method(MultipleShooting(25), Ipopt())
    fast, slow = (
        horizon_run(symmetric, values, noisy, 100, method=method) for method in (GAUSS_NEWTON, thesis)
    )
    np.testing.assert_allclose(slow.initial_states, fast.initial_states, atol=1e-6)
    assert not np.array_equal(slow.initial_states, fast.initial_states), "another method was used"
