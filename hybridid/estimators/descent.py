"""The descent from one or several starts to an optimum, for every fit and every refit.

1. Several starts: a short descent from each selects one, which then converges; or each converges.
2. Continuation: sign(v) is smoothed widely first, then as declared. Each descent starts where the last ended.
3. Second look: a horizon whose initial state is worse than another candidate starts again from that one.
4. Handover: inner states of effects pass from horizon to horizon, until the cost no longer changes.
5. Refinement: where the optimum needs shorter steps a sample, the descent continues with them.

``Problem`` is what is solved, ``Method`` what solves it. A ``Descent`` holds the settings of a caller.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from hybridid.estimators.carried import carries_nothing, carry, run_on
from hybridid.estimators.estimate import Solution
from hybridid.estimators.method import GAUSS_NEWTON, STOP, Method
from hybridid.estimators.problem import Problem
from hybridid.estimators.reduced import promise
from hybridid.estimators.start import best_initial_states
from hybridid.estimators.stop import Stop, Watch

Array = NDArray[np.float64]
BLURRED = 1.5**2
"""Ratio of the costs at the widest and the narrowest smoothing above which the records refute the wide one: a
descent there would fit the error of the smoothing."""
SETTLED = 1e-3
"""Relative change of the cost below which handing inner states on changes nothing more."""
OTHERS = Stop(30, 1e-5)
"""For the initial states of horizons that are not fitted, at given parameters."""


@dataclass(frozen=True)
class Handover:
    """Inner states are handed on at most ``times``, each time with a descent of its own."""

    times: int
    stop: Stop


@dataclass(frozen=True)
class Refinement:
    """Shorter steps are taken at most ``times``, each time with its own ``handover``; ``must_hold`` keeps the
    longer steps where the simulation with the shorter ones diverges."""

    times: int
    handover: Handover
    must_hold: bool


@dataclass(frozen=True)
class Descent:
    """Settings of a descent.

    ``continuation`` multiplies the smoothing widths, one after the other; ``stop`` ends each. ``screening``
    ends the short descent from each start, at the widest and the narrowest smoothing alone. The start with
    the lowest cost then descends to convergence, by every smoothing unless the records refute the widest. It
    does not if its cost is above ``hopeful`` and a Gauss-Newton step promises none below. None: every start
    does, and the lowest cost is kept. Above ``cost_limit`` inner states are not handed on.
    """

    handover: Handover
    refinement: Refinement
    method: Method = GAUSS_NEWTON
    continuation: tuple[float, ...] = (1.0,)
    stop: Stop = STOP
    screening: Stop | None = None
    cost_limit: float = np.inf
    hopeful: float = np.inf


@dataclass(frozen=True)
class Start:
    """A problem, and where to begin in it: parameters (n_p,), initial states of all horizons (w, n_x).

    ``candidates`` are the initial states (w, n_x) that the second look chooses from, none for no second look.
    """

    problem: Problem
    p: Array
    x0: Array
    candidates: tuple[Array, ...] = ()
    watch: Watch | None = None


@dataclass(frozen=True)
class Result:
    """Where a descent ended: the ``solution`` on the fitted horizons, initial states ``x0`` (w, n_x) of all
    horizons, and the cost at which each of the ``starts`` ended that were carried to the end. ``diverged``
    are the numbers of those whose short descent could not be simulated. ``ended_early``: none was hopeful."""

    problem: Problem
    solution: Solution
    x0: Array
    starts: tuple[float, ...] = ()
    diverged: tuple[int, ...] = ()
    ended_early: bool = False


Finer = Callable[[Result], Start | None]
"""Where to go on with shorter steps; None where those in use are short enough."""


def descend(starts: Iterable[Start], plan: Descent, fitted: Sequence[int] | None = None) -> Result:
    """The lowest cost that is reached from ``starts``, infinite if each start diverges.

    ``fitted`` are the numbers of the horizons that count (None: all). Of the others the initial states are
    estimated at the parameters found.
    """
    if plan.screening is not None:
        return _from_the_best(starts, plan, plan.screening, fitted)
    results = [_settled(start, plan, plan.continuation, plan.handover, fitted) for start in starts]
    costs = tuple(one.solution.cost for one in results)
    return replace(results[int(np.argmin(costs))], starts=costs)


def refine(found: Result, plan: Descent, finer: Finer, fitted: Sequence[int] | None = None) -> Result:
    """``found``, or where the descent ends that goes on from it with as many steps a sample as ``finer`` asks
    for; ``fitted`` as for ``descend``. What ended early stays."""
    for _ in range(0 if found.ended_early else plan.refinement.times):
        start = finer(found)
        if start is None:
            break
        again = _settled(start, plan, plan.continuation[-1:], plan.refinement.handover, fitted)
        if plan.refinement.must_hold and not np.isfinite(again.solution.cost):
            break
        solution = _after(found.solution, again.solution, again.solution)
        found = replace(again, solution=solution, starts=found.starts, diverged=found.diverged)
    return found


@dataclass(frozen=True)
class _Look:
    """Where a short descent from a start ended: it goes on from there, by the smoothings ``factors``."""

    start: Start
    seen: Solution
    factors: tuple[float, ...]

    def goes_on(self, plan: Descent) -> Descent:
        """``plan`` with the iterations of the smoothings that are left out."""
        times = len(plan.continuation) // len(self.factors)
        return replace(plan, stop=replace(plan.stop, iterations=times * plan.stop.iterations))


def _from_the_best(
    starts: Iterable[Start], plan: Descent, stop: Stop, fitted: Sequence[int] | None
) -> Result:
    """Of ``starts`` the one from which a short descent, until ``stop``, gets farthest, carried to the end if
    it is hopeful; if it diverges, the next one."""
    looks = [_look(start, plan, stop, fitted) for start in starts]
    diverged = tuple(k for k, one in enumerate(looks) if not np.isfinite(one.seen.cost))
    looks.sort(key=lambda one: one.seen.cost)
    if np.isfinite(looks[0].seen.cost) and not _hopeful(looks[0], plan, fitted):
        return replace(_ended_early(looks[0], plan, stop, fitted), diverged=diverged)
    costs: list[float] = []
    for look in looks:
        found = _settled(look.start, look.goes_on(plan), look.factors, plan.handover, fitted)
        costs.append(found.solution.cost)
        if np.isfinite(costs[-1]):
            break
    return replace(found, starts=tuple(costs), diverged=diverged)


def _look(start: Start, plan: Descent, stop: Stop, fitted: Sequence[int] | None) -> _Look:
    """A short descent at the widest smoothing, then one at the narrowest, if anything is smoothed."""
    task = _Task.of(start, plan.method, fitted)
    widest, narrowest = plan.continuation[:1], plan.continuation[-1:]
    wide = task.solve(start.p, start.x0, widest, stop)
    seen, factors = wide, plan.continuation
    if widest != narrowest and start.problem.widths:
        seen = task.solve(wide.p, task.with_ours(start.x0, wide.x0), narrowest, stop)
        factors = narrowest if wide.cost > BLURRED * seen.cost else factors
    return _Look(replace(start, p=seen.p, x0=task.with_ours(start.x0, seen.x0)), seen, factors)


def _hopeful(look: _Look, plan: Descent, fitted: Sequence[int] | None) -> bool:
    """Whether the cost is low enough where the short descent ended, or is promised to be."""
    if look.seen.cost <= plan.hopeful:
        return True
    counting = _Task.of(look.start, plan.method, fitted).counting
    return look.seen.cost - promise(counting, look.seen.p, look.seen.x0) <= plan.hopeful


def _ended_early(look: _Look, plan: Descent, stop: Stop, fitted: Sequence[int] | None) -> Result:
    """The short descent as a result; the other horizons' initial states are estimated until ``stop``."""
    task, seen, x0 = _Task.of(look.start, plan.method, fitted), look.seen, look.start.x0
    if task.theirs:
        handed = task.handed_on(seen.p, x0, plan.continuation[-1:], stop)
        x0 = run_on(look.start.problem, seen.p, handed)
    solution = replace(seen, status="ended early: it promises little")
    return Result(look.start.problem, solution, x0, (seen.cost,), ended_early=True)


def _settled(
    start: Start, plan: Descent, factors: Sequence[float], handover: Handover, fitted: Sequence[int] | None
) -> Result:
    """One start carried to the end."""
    task, final = _Task.of(start, plan.method, fitted), factors[-1:]
    solution = task.solve(start.p, start.x0, factors, plan.stop)
    if start.candidates and np.isfinite(solution.cost):
        solution = _second_look(task, solution, final, plan.stop)
    x0 = task.with_ours(start.x0, solution.x0)
    if task.needs_handover and solution.cost <= plan.cost_limit:
        solution, x0 = _handed_over(task, solution, x0, final, handover)
    if task.theirs:
        x0 = run_on(start.problem, solution.p, task.handed_on(solution.p, x0, final))
    return Result(start.problem, solution, x0)


def _second_look(task: _Task, solution: Solution, factors: Sequence[float], stop: Stop) -> Solution:
    """The lower of ``solution`` and of a descent from the best initial states at hand: where a horizon first
    began, it may have been trapped."""
    x0 = task.with_ours(task.start.x0, solution.x0)
    freed = best_initial_states(task.start.problem, solution.p, [x0, *task.start.candidates])
    if np.array_equal(freed, x0):
        return solution
    again = task.solve(solution.p, freed, factors, stop)
    return _after(solution, again if again.cost < solution.cost else solution, again)


def _handed_over(
    task: _Task, solution: Solution, x0: Array, factors: Sequence[float], handover: Handover
) -> tuple[Solution, Array]:
    """The solution, and ``x0`` (w, n_x), with inner states handed on until the cost stays."""
    for _ in range(handover.times):
        x0 = task.handed_on(solution.p, x0, factors)
        before, again = solution, task.solve(solution.p, x0, factors, handover.stop)
        solution, x0 = _after(before, again, again), task.with_ours(x0, again.x0)
        if abs(before.cost - solution.cost) <= SETTLED * solution.cost:
            break
    return solution, x0


@dataclass(frozen=True)
class _Task:
    """A start, the method, and which horizons count, by number: ``ours`` do, ``theirs`` do not."""

    start: Start
    method: Method
    ours: list[int]
    theirs: list[int]

    @classmethod
    def of(cls, start: Start, method: Method, fitted: Sequence[int] | None) -> _Task:
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


def _after(first: Solution, kept: Solution, second: Solution) -> Solution:
    """``kept``, with the iterations of two descents."""
    return replace(kept, iterations=first.iterations + second.iterations)
