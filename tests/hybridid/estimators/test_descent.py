"""One descent for fits and refits: which starts are carried on, and what horizons that do not count get."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from hybridid.estimators import screening
from hybridid.estimators.descent import descend, go_on, refine
from hybridid.estimators.estimate import Solution
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
    [
        (0.0, [(2 * PLAN.stop.iterations, (1.0,))]),
        # by every smoothing it ends above what was seen without the wide one: it goes on from there, too
        (np.inf, [(PLAN.stop.iterations, factors) for factors in ((1000.0, 1.0), (1.0,))]),
    ],
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
    descend(starts[1:2], plan)
    assert used == [(4, (1000.0,)), (4, (1.0,)), *goes_on]


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


class Scripted(SimpleNamespace):
    """A start that costs ``begun`` before any descent, where sign(v) is not smoothed widely; the descent from
    it ends at ``wide`` where it is, and at ``sharp`` where it is not."""

    begun = np.inf

    @property
    def start(self):
        return Start(self.problem, np.array([1.0, self.place]), np.zeros((1, 1)))

    def cost(self, p, x0, factor):
        return self.begun

    def solve(self, p, x0, factors, stop):
        self.looks.append((self.number, tuple(factors)))
        return Solution(p, x0, self.sharp if factors == (1.0,) else self.wide, "short", False, 1)

    solve_widely = solve

    def with_ours(self, x0, values):
        return values


def looked_at(problem, costs, places=None, begun=()):
    """The numbers of the starts that are looked at sharply, and of all in the order in which they go on."""
    looks, smoothed = [], SimpleNamespace(widths=problem)
    tasks = [
        Scripted(number=k, wide=wide, sharp=sharp, place=place, looks=looks, problem=smoothed)
        for k, ((wide, sharp), place) in enumerate(zip(costs, places or range(len(costs)), strict=True))
    ]
    for task, cost in zip(tasks, begun, strict=False):
        task.begun = cost
    plan = replace(PLAN, continuation=(10.0, 1.0))
    ordered = screening._looks(tasks, plan, STOP)
    return sorted(k for k, factors in looks if factors == (1.0,)), list(ordered)


def test_the_three_best_starts_at_the_widest_smoothing_are_looked_at_sharply(problem):
    costs = [(5.0, 4.9), (2.0, 1.9), (4.0, 1.0), (3.0, 2.8), (1.0, 1.5)]
    assert looked_at(problem, costs) == ([1, 3, 4], [4, 1, 3, 2, 0])


def test_a_start_that_costs_less_than_where_all_end_goes_on_from_where_it_is(problem):
    costs = [(5.0, 4.9), (2.0, 1.9), (4.0, 2.5), (3.0, 2.8), (2.5, 2.4)]
    assert looked_at(problem, costs) == ([1, 3, 4], [1, 4, 3, 2, 0])
    assert looked_at(problem, costs, begun=(9.0, 9.0, 1.95, 9.0, 9.0)) == ([1, 3, 4], [1, 4, 3, 2, 0])
    costs[2] = (4.0, 1.7)
    assert looked_at(problem, costs, begun=(9.0, 9.0, 1.8, 9.0, 9.0)) == ([1, 2, 3, 4], [2, 1, 4, 3, 0])


def test_starts_that_have_met_are_looked_at_once(problem):
    costs = [(1.0, 1.0), (1.0005, 1.0), (2.0, 2.0), (3.0, 3.0), (4.0, 4.0)]
    sharp, _ = looked_at(problem, costs, places=(7.0, 7.1, 8.0, 9.0, 10.0))
    assert sharp == [0, 2, 3]
    apart, _ = looked_at(problem, costs, places=(7.0, 7.2, 8.0, 9.0, 10.0))
    assert apart == [0, 1, 2]


def test_every_start_is_looked_at_sharply_where_the_wide_smoothing_is_refuted(problem):
    costs = [(10.0, 1.0), (11.0, 3.0), (12.0, 3.0), (13.0, 0.5), (14.0, 3.0)]
    assert looked_at(problem, costs) == ([0, 1, 2, 3, 4], [3, 0, 1, 2, 4])


def test_a_start_that_diverges_at_the_widest_smoothing_has_a_second_chance(problem):
    costs = [(np.inf, 0.4), (1.0, 1.0), (2.0, 2.0), (3.0, 3.0), (4.0, 4.0)]
    sharp, order = looked_at(problem, costs)
    assert sharp[0] == 0
    assert order[0] == 0
