"""One start of a descent carried to the end: second look, handover, and horizons that do not count."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from hybridid.estimators.carried import carries_nothing, carry, run_on
from hybridid.estimators.estimate import Solution
from hybridid.estimators.method import Method
from hybridid.estimators.plan import Descent, Handover, Result, Start
from hybridid.estimators.problem import Problem
from hybridid.estimators.start import best_initial_states
from hybridid.estimators.stop import Stop
from hybridid.estimators.wide_steps import in_wide_steps

Array = NDArray[np.float64]
SETTLED = 1e-3
"""Relative change of the cost below which handing inner states on changes nothing more."""
TRAPPED = 0.9
"""Share of a horizon's cost: if less is left from another initial state, before any descent from there, the
horizon is trapped where it is."""
OTHERS = Stop(30, 1e-5)
"""For the initial states of horizons that are not fitted, at given parameters."""


@dataclass(frozen=True)
class Task:
    """A start, the method, and which horizons count, by number: ``ours`` do, ``theirs`` do not."""

    start: Start
    method: Method
    ours: list[int]
    theirs: list[int]

    @classmethod
    def of(cls, start: Start, method: Method, fitted: Sequence[int] | None) -> Task:
        """``fitted`` are the numbers of the horizons that count (None: all)."""
        every = range(start.problem.windows.count)
        ours = every if fitted is None else fitted
        return cls(start, method, list(ours), [k for k in every if k not in ours])

    @cached_property
    def counting(self) -> Problem:
        """The problem on the horizons that count."""
        return self.start.problem.on(self.ours) if self.theirs else self.start.problem

    @cached_property
    def others(self) -> Problem:
        """The problem on the horizons that do not, with every parameter known."""
        return self.start.problem.on(self.theirs).estimating(())

    def solve(self, p: Array, x0: Array, factors: Sequence[float], stop: Stop) -> Solution:
        """A descent on the horizons that count, from the initial states ``x0`` (w, n_x) of all."""
        return self.method.solve(self.counting, p, x0[self.ours], factors, stop, self.start.watch)

    def solve_widely(self, p: Array, x0: Array, factors: Sequence[float], stop: Stop) -> Solution:
        """As ``solve``, in the steps that the last of the smoothings ``factors`` needs."""
        problem = in_wide_steps(self.counting, p, factors[-1])
        return self.method.solve(problem, p, x0[self.ours], factors, stop, self.start.watch)

    def cost(self, p: Array, x0: Array, factor: float) -> float:
        """The cost on the horizons that count at ``p`` (n_p,) and the initial states ``x0`` (w, n_x) of all,
        with the smoothing widths times ``factor``."""
        shot = self.counting.shot(x0[self.ours], self.counting.smoothed(p, factor), sensitivities=False)
        return self.counting.cost(shot)

    def with_ours(self, x0: Array, values: Array) -> Array:
        """``x0`` (w, n_x) with ``values`` for the horizons that count."""
        changed = np.array(x0)
        changed[self.ours] = values
        return changed

    @property
    def needs_handover(self) -> bool:
        """Whether inner states come from horizons that do not count, or the solver does not hand them on."""
        alone = self.method.solver.hands_on and self.counting.windows.complete
        return not (carries_nothing(self.counting) or alone)

    def handed_on(self, p: Array, x0: Array, factors: Sequence[float], stop: Stop = OTHERS) -> Array:
        """``x0`` (w, n_x) with inner states as the horizons before have left them, then the initial states of
        those that do not count estimated at ``p`` (n_p,)."""
        x0 = np.array(carry(self.start.problem, p, x0))
        if self.theirs:
            x0[self.theirs] = self.method.solve(self.others, p, x0[self.theirs], factors, stop).x0
        return x0


def carried_unless_lost(
    start: Start,
    plan: Descent,
    factors: Sequence[float],
    fitted: Sequence[int] | None,
    sharp: Start,
    cost: float,
) -> Result:
    """``start`` carried to the end by the smoothings ``factors``.

    Where that ends above ``cost``, which ``sharp`` has at the narrowest, a wider one has led it astray. Then
    ``sharp`` is carried to the end at the narrowest alone, and the lower end is kept.
    """
    found = carried_to_the_end(start, plan, factors, plan.handover, fitted)
    if len(factors) == 1 or found.solution.cost <= (1 + SETTLED) * cost:
        return found
    again = carried_to_the_end(sharp, plan, factors[-1:], plan.handover, fitted)
    return again if again.solution.cost < found.solution.cost else found


def carried_to_the_end(
    start: Start, plan: Descent, factors: Sequence[float], handover: Handover, fitted: Sequence[int] | None
) -> Result:
    """One start carried to the end."""
    task, final = Task.of(start, plan.method, fitted), factors[-1:]
    solution = task.solve(start.p, start.x0, factors, plan.stop)
    if start.candidates and np.isfinite(solution.cost):
        solution = _second_look(task, solution, final, plan.stop)
    x0 = task.with_ours(start.x0, solution.x0)
    if task.needs_handover and solution.cost <= plan.cost_limit:
        solution, x0 = _handed_over(task, solution, x0, final, handover)
    if task.theirs:
        begun = _others_begun(task, solution, x0)
        x0 = run_on(start.problem, solution.p, task.handed_on(solution.p, begun, final))
    return Result(start.problem, solution, x0)


def _others_begun(task: Task, solution: Solution, x0: Array) -> Array:
    """``x0`` (w, n_x) with the best initial states at hand for the horizons that do not count: those of
    another model may be far away."""
    start = task.start
    if not start.candidates or not np.isfinite(solution.cost):
        return x0
    best = best_initial_states(start.problem, solution.p, [x0, *start.candidates])
    return task.with_ours(best, x0[task.ours])


def _second_look(task: Task, solution: Solution, factors: Sequence[float], stop: Stop) -> Solution:
    """The lower of ``solution`` and of a descent from the best initial states at hand: where a horizon first
    began, it may have been trapped."""
    x0 = task.with_ours(task.start.x0, solution.x0)
    freed = best_initial_states(task.start.problem, solution.p, [x0, *task.start.candidates], TRAPPED)
    if np.array_equal(freed, x0):
        return solution
    again = task.solve(solution.p, freed, factors, stop)
    return added(solution, again if again.cost < solution.cost else solution, again)


def _handed_over(
    task: Task, solution: Solution, x0: Array, factors: Sequence[float], handover: Handover
) -> tuple[Solution, Array]:
    """The solution, and ``x0`` (w, n_x), with inner states handed on until the cost stays."""
    for _ in range(handover.times):
        x0 = task.handed_on(solution.p, x0, factors)
        before, again = solution, task.solve(solution.p, x0, factors, handover.stop)
        solution, x0 = added(before, again, again), task.with_ours(x0, again.x0)
        if abs(before.cost - solution.cost) <= SETTLED * solution.cost:
            break
    return solution, x0


def added(first: Solution, kept: Solution, second: Solution) -> Solution:
    """``kept``, with the iterations of two descents."""
    return replace(kept, iterations=first.iterations + second.iterations)
