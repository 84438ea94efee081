"""One descent for fits and refits: which starts are carried on, and what horizons that do not count get."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from hybridid.estimators import screening
from hybridid.estimators.descent import descend, go_on, refine
from hybridid.estimators.plan import Descent, Handover, Refinement, Start
from hybridid.estimators.problem import build_problem
from hybridid.estimators.stop import Stop

STOP = Stop(40, 1e-8)
PLAN = Descent(Handover(3, STOP), Refinement(2, Handover(0, STOP), must_hold=True), stop=STOP)


@pytest.fixture(scope="module")
def problem(symmetric, noisy):
    return build_problem(symmetric, [noisy], 50, 2)


@pytest.fixture(scope="module")
def starts(problem):
    """A start that diverges, one far off and one near."""
    x0 = problem.measured_x0()
    near = problem.model.values()
    far, wild = 3 * near, np.where(near == 0, near, np.nan)
    return [Start(problem, p, x0) for p in (wild, far, near)]


def test_each_start_is_carried_to_the_end_and_the_lowest_kept(starts):
    found = descend(starts, PLAN)
    assert len(found.starts) == 3
    assert found.starts[0] == np.inf
    assert found.solution.cost == min(found.starts)
    np.testing.assert_array_equal(found.x0, found.solution.x0)


def test_after_a_screening_only_the_most_promising_is(starts):
    found = descend(starts, replace(PLAN, screening=Stop(3, 1e-3)))
    assert len(found.starts) == 1
    assert found.solution.cost == pytest.approx(min(descend(starts, PLAN).starts), rel=1e-6)


def test_a_screened_start_that_promises_little_goes_no_further(starts):
    plan = replace(PLAN, screening=Stop(3, 1e-3))
    lowest = descend(starts, plan).solution.cost
    hopeless = descend(starts, replace(plan, hopeful=0.1 * lowest))
    assert hopeless.ended_early
    assert not hopeless.solution.converged
    assert hopeless.diverged == (0,)
    assert hopeless.solution.cost > lowest
    went_on = go_on(hopeless, plan)
    assert not went_on.ended_early
    assert went_on.solution.cost == lowest
    assert went_on.diverged == (0,)
    promised = descend(starts, replace(plan, hopeful=1.1 * lowest))
    assert not promised.ended_early
    assert promised.solution.cost == lowest


@pytest.mark.parametrize(
    ("refuted_from", "goes_on"),
    [(0.0, (2 * PLAN.stop.iterations, (1.0,))), (np.inf, (PLAN.stop.iterations, (1000.0, 1.0)))],
)
def test_a_wide_smoothing_that_the_records_refute_is_left_out(starts, monkeypatch, refuted_from, goes_on):
    monkeypatch.setattr(screening, "BLURRED", refuted_from)
    used = []

    class Told:
        def __init__(self, method):
            self.solver, self.method = method.solver, method

        def solve(self, problem, p, x0, factors, stop, watch=None):
            used.append((stop.iterations, tuple(factors)))
            return self.method.solve(problem, p, x0, factors, stop, watch)

    plan = replace(PLAN, continuation=(1000.0, 1.0), screening=Stop(4, 1e-3), method=Told(PLAN.method))
    descend(starts[2:], plan)
    assert used == [(4, (1000.0,)), (4, (1.0,)), goes_on]


def test_horizons_that_do_not_count_get_initial_states_but_no_say(problem, starts):
    fitted = list(range(0, problem.windows.count, 2))
    others = [k for k in range(problem.windows.count) if k not in fitted]
    start = replace(starts[2], x0=starts[2].x0 + 0.01)
    found = descend([start], PLAN, fitted)
    part = problem.on(others)
    alone = descend([Start(problem.on(fitted), start.p, start.x0[fitted])], PLAN)
    np.testing.assert_allclose(found.solution.p, alone.solution.p, rtol=1e-12)
    before, after = (part.cost(part.shooter(x0[others], found.solution.p)) for x0 in (start.x0, found.x0))
    assert after < 1e-2 * before


def test_shorter_steps_are_taken_as_long_as_they_are_asked_for(problem, starts):
    found = descend(starts[2:], PLAN)
    asked = []

    def finer(result):
        steps = 2 * result.problem.windows.substeps
        asked.append(steps)
        return Start(build_problem(problem.model, problem.records, 50, steps), found.solution.p, found.x0)

    refined = refine(found, PLAN, finer)
    assert asked == [4, 8], "at most twice, as the settings say"
    assert refined.problem.windows.substeps == 8
    assert refined.starts == found.starts
    assert refine(found, PLAN, lambda result: None) is found
