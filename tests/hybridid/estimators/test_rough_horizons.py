"""A trial step that fails in a few horizons is mended in these, and the descent goes on. All simulated."""

from __future__ import annotations

import numpy as np
import pytest

from hybridid.estimators.problem import build_problem
from hybridid.estimators.reduced import LeastSquares
from hybridid.estimators.rough_horizons import has_own_states, mended

EFFECTS = ("viscous", "coulomb", "offset")


@pytest.fixture
def problem(carriage, make_model):
    return build_problem(make_model(EFFECTS), [carriage.record(600)], 100, 2)


@pytest.fixture
def here(problem, carriage):
    """Initial states and their shot at the carriage's own parameters."""
    x0 = problem.measured_x0()
    return x0, problem.shooter(x0, problem.model.values(carriage.truth))


def test_only_the_horizon_that_got_worse_is_sought_again(problem, here, carriage):
    x0, _ = here
    p = problem.model.values(carriage.truth)
    tried = x0.copy()
    tried[3, 1] += 0.3  # m/s
    there = problem.shooter(tried, p)
    whole = problem.cost(there)
    x, found = mended(problem, here, (tried, there), p, 0.5 * whole)
    np.testing.assert_array_equal(np.delete(x, 3, axis=0), np.delete(tried, 3, axis=0))
    before, after = problem.costs(there), problem.costs(found)
    assert after[3] < 1e-2 * before[3]
    assert np.delete(after, 3) == pytest.approx(np.delete(before, 3))
    assert problem.cost(found) == pytest.approx(after.sum())
    for enough in (1e-6 * whole, 2 * whole):  # too little is gained, or nothing is wanted
        given = (tried, there)
        assert mended(problem, here, given, p, enough) is given


def test_a_trial_that_gets_better_or_worse_everywhere_stays(problem, here, carriage):
    x0, _ = here
    p = problem.model.values(carriage.truth)
    worse = x0 + np.array([0.0, 0.3])
    for tried in (x0, worse):
        given = (tried, problem.shooter(tried, p))
        assert mended(problem, here, given, p, np.inf if tried is worse else 0.0) is given


def test_it_is_for_several_horizons_that_find_their_own_states(problem, carriage, make_model):
    assert has_own_states(problem)
    record = carriage.record(600)
    assert not has_own_states(build_problem(make_model(EFFECTS), [record], None, 2))
    assert not has_own_states(build_problem(make_model(EFFECTS), [record], 100, 2, estimate_x0=False))
    assert not has_own_states(build_problem(make_model(("viscous", "dahl")), [record], 100, 2))


def test_the_length_of_a_step_is_that_of_the_whole_equations(problem, here):
    """Against the Schur complement of the full matrix."""
    x0, _ = here
    normal = LeastSquares.of(problem).linearised(
        problem.shooter(x0, problem.model.values(), sensitivities=True)
    )
    w, m, n = normal.xp.shape
    full = np.zeros((w * m + n, w * m + n))
    for k in range(w):
        rows = slice(k * m, (k + 1) * m)
        full[rows, rows], full[rows, w * m :], full[w * m :, rows] = (
            normal.xx[k],
            normal.xp[k],
            normal.xp[k].T,
        )
    full[w * m :, w * m :] = normal.pp
    covariance = np.linalg.inv(full)[w * m :, w * m :]
    dp = np.linspace(0.5, 1.0, n)
    assert normal.of_parameters(dp) == pytest.approx(dp @ np.linalg.inv(covariance) @ dp, rel=1e-6)
