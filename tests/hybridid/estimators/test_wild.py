"""A horizon whose sensitivities grow without end neither holds a descent nor makes standard errors."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from hybridid.estimators.problem import build_problem
from hybridid.estimators.reduced import LeastSquares
from hybridid.estimators.uncertainty import uncertainty
from hybridid.estimators.wild import WILD, wild


@pytest.mark.parametrize(
    ("sizes", "lost"),
    [
        ([1.0, 2.0, 3.0, 10 * WILD], [False, False, False, True]),
        ([1e-9, 1e-9, 1e-9, 50.0], [False] * 4),  # a machine that mostly rests
        ([30.0, 30.0, 30.0, 10 * WILD], [False] * 4),
        ([1.0, 3 * WILD, 3 * WILD, 3 * WILD], [False] * 4),  # all over: no horizon is better
        ([1.0, 1.0, np.inf, np.nan], [False] * 4),
        ([], []),
    ],
)
def test_wild_is_what_is_far_beyond_the_others_and_beyond_all_measure(sizes, lost):
    assert wild(np.array(sizes)).tolist() == lost


@pytest.fixture(scope="module")
def solved(make_model, carriage):
    """A problem, and a simulation of it near the truth; of the second one, a horizon is wild."""
    problem = build_problem(make_model(), [carriage.record(2000)], 100, 4, True)
    x0 = problem.measured_x0()
    p = problem.model.values()
    shot = problem.shooter(x0, p, sensitivities=True)
    by = np.array(shot.by_parameter)
    by[5] *= 1e13
    return problem, p, x0, shot, replace(shot, by_parameter=by)


def test_standard_errors_are_those_of_the_others(solved):
    problem, p, x0, shot, blown = solved
    before, after = (uncertainty(problem, p, x0, shot=one).std for one in (shot, blown))
    assert after == pytest.approx(before, rel=0.5)


def test_the_step_is_that_of_the_others(solved):
    problem, _, _, shot, blown = solved
    variables = LeastSquares.of(problem)
    free = np.zeros(len(variables.p), dtype=bool)
    before, after = (variables.linearised(one).step(1e-8, free)[0] for one in (shot, blown))
    assert after == pytest.approx(before, rel=0.5, abs=0.1 * np.abs(before).max())
