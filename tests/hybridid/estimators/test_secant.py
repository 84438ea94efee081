"""Steps that learn what Gauss-Newton leaves out end in the same optimum, sooner."""

from __future__ import annotations

import numpy as np
import pytest

from hybridid.estimators.levenberg_marquardt import LevenbergMarquardt
from hybridid.estimators.method import Method
from hybridid.estimators.normal_equations import Normal
from hybridid.estimators.problem import build_problem
from hybridid.estimators.reduced import LeastSquares, Reduced
from hybridid.estimators.secant import CONVEX, Secant
from hybridid.estimators.stop import Stop


@pytest.fixture(scope="module")
def lacking(carriage, make_model):
    """A model without a friction that the carriage has: its error is large."""
    return build_problem(make_model(("coulomb",)), [carriage.record(600)], 200, 2, estimate_x0=False)


def normal_of(square, gradient):
    n = len(gradient)
    return Normal(square, np.zeros((1, 2, 2)), np.zeros((1, 2, n)), gradient, np.zeros((1, 2)))


def test_the_same_optimum_in_fewer_steps(lacking):
    start, stop = (lacking.model.values(), lacking.measured_x0()), Stop(200, 1e-14)
    plain, learned = (
        Method(Reduced(), LevenbergMarquardt(learns=learns)).solve(lacking, *start, stop=stop)
        for learns in (False, True)
    )
    assert plain.converged
    assert learned.converged
    assert learned.cost == pytest.approx(plain.cost, rel=1e-12)
    np.testing.assert_allclose(learned.p, plain.p, rtol=1e-5)
    assert learned.iterations < plain.iterations


def test_the_estimate_acts_along_the_last_step_as_the_gradients_say():
    draw = np.random.default_rng(2)
    square = np.diag([4.0, 1.0, 9.0])
    left = draw.normal(size=(3, 3))
    hessian = square + 0.3 * (left + left.T)
    secant, place = Secant(np.zeros((3, 3))), np.zeros(3)
    for step in np.vstack([np.zeros(3), draw.normal(size=(4, 3))]):
        place = place + step
        secant = secant.at(place, 0.5 * place @ hessian @ place, normal_of(square, hessian @ place))
        np.testing.assert_allclose((square + secant.matrix) @ step, hessian @ step, atol=1e-12)
        np.testing.assert_allclose(secant.matrix, secant.matrix.T, atol=1e-12)


def test_the_equations_stay_convex():
    square = np.diag([4.0, 1.0])
    found = Secant(np.diag([-100.0, 3.0]), uses=True).added_to(normal_of(square, np.zeros(2)))
    np.testing.assert_allclose(found.pp, np.diag([4.0 * (1 + CONVEX), 4.0]), rtol=1e-9)


@pytest.mark.parametrize(("curvature", "uses"), [(1.1, False), (2.0, True)])
def test_it_is_used_where_gauss_newton_tells_the_decrease_poorly(curvature, uses):
    """Of a cost with so many times the curvature of J'J."""
    secant = Secant(np.zeros((1, 1)))
    for at in (1.0, 0.0):
        place = np.array([at])
        secant = secant.at(place, 0.5 * curvature * at**2, normal_of(np.eye(1), curvature * place))
    assert secant.uses is uses
    assert secant.matrix[0, 0] == pytest.approx(curvature - 1)


def test_where_initial_states_are_estimated_nothing_is_learned(carriage, make_model):
    problem = build_problem(make_model(("viscous",)), [carriage.record(300)], 100, 2)
    assert Secant.of(LeastSquares.of(problem)) is None
