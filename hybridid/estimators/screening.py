"""Of several starts one is carried on: a short descent from each shows which, and whether it is worth it."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace

import numpy as np

from hybridid.estimators.carried import run_on
from hybridid.estimators.estimate import Solution
from hybridid.estimators.one_start import Task, carried_unless_lost
from hybridid.estimators.plan import Descent, Look, Result, Start
from hybridid.estimators.reduced import promise
from hybridid.estimators.stop import Stop

BLURRED = 1.5**2
"""Ratio of the costs at the widest and the narrowest smoothing above which the records refute the wide one: a
descent there would fit the error of the smoothing."""
BEST = 3
"""Starts with the lowest costs at the widest smoothing that are looked at with the narrowest."""
NEAR = 1e-3, 0.02
"""Relative differences of the costs and of every parameter up to which two starts have met."""


def from_the_best(starts: Iterable[Start], plan: Descent, stop: Stop, fitted: Sequence[int] | None) -> Result:
    """Of ``starts`` the one from which a short descent, until ``stop``, gets farthest, carried to the end if
    it is hopeful; if it diverges, the next one."""
    looks = _looks([Task.of(start, plan.method, fitted) for start in starts], plan, stop)
    diverged = tuple(sorted(k for k, one in looks.items() if not np.isfinite(one.seen.cost)))
    ordered = list(looks.values())
    if np.isfinite(ordered[0].seen.cost) and not _hopeful(ordered[0], plan, fitted):
        ended = _ended_early(ordered[0], plan, stop, fitted)
        return replace(ended, diverged=diverged, looks=tuple(ordered))
    return replace(from_looks(ordered, plan, fitted), diverged=diverged)


def from_looks(looks: Sequence[Look], plan: Descent, fitted: Sequence[int] | None) -> Result:
    """The first of ``looks`` that does not diverge, carried to the end."""
    costs: list[float] = []
    for look in looks:
        found = _carried(look, plan, fitted)
        costs.append(found.solution.cost)
        if np.isfinite(costs[-1]):
            break
    return replace(found, starts=tuple(costs))


def _carried(look: Look, plan: Descent, fitted: Sequence[int] | None) -> Result:
    """A look carried to the end, from what was seen at the narrowest smoothing if the others lead astray."""
    x0 = Task.of(look.start, plan.method, fitted).with_ours(look.start.x0, look.seen.x0)
    sharp = replace(look.start, p=look.seen.p, x0=x0)
    return carried_unless_lost(look.start, look.rest_of(plan), look.factors, fitted, sharp, look.seen.cost)


def _looks(tasks: Sequence[Task], plan: Descent, stop: Stop) -> dict[int, Look]:
    """Where the short descents from each start ended, by its number, the lowest cost first.

    All are made at the widest smoothing. The ``BEST`` of these that have not met one another go on at the
    narrowest, as do those that diverged; all of them, where the records refute the wide one. Those that do
    not go on come after those that did.

    A start may cost less than where all of these end: the wide descents have fitted the error of the
    smoothing. Then the one that costs least goes on from where it is, at the narrowest smoothing alone. So a
    start at nothing keeps what the model without the effect explains.
    """
    widest, narrowest = plan.continuation[:1], plan.continuation[-1:]
    looks = {k: _look(task, widest, plan.continuation, stop) for k, task in enumerate(tasks)}
    if widest == narrowest or not tasks[0].start.problem.widths:
        return _by_cost(looks)
    sharp: dict[int, Look] = {}
    for chosen in (_apart(looks), looks):
        new = {k: _sharpened(looks[k], tasks[k], narrowest, stop) for k in chosen if k not in sharp}
        sharp = _by_cost({**sharp, **new})
        best = next(iter(sharp.values()))
        if np.isfinite(best.seen.cost) and best.factors != narrowest:
            break
    costs = [task.cost(task.start.p, task.start.x0, narrowest[-1]) for task in tasks]
    if min(costs) < best.seen.cost:
        k = int(np.argmin(costs))
        sharp = _by_cost({**sharp, k: _look(tasks[k], narrowest, narrowest, stop)})
    return {**sharp, **_by_cost({k: one for k, one in looks.items() if k not in sharp})}


def _apart(looks: Mapping[int, Look]) -> list[int]:
    """The numbers of the ``BEST`` of ``looks`` that have not met, and of those that diverged."""
    apart: list[int] = []
    for k, one in _by_cost(looks).items():
        met = any(_have_met(one.seen, looks[other].seen) for other in apart)
        if (len(apart) < BEST and not met) or not np.isfinite(one.seen.cost):
            apart.append(k)
    return apart


def _have_met(one: Solution, other: Solution) -> bool:
    """Whether two descents have come to the same place; ``other`` has the lower cost."""
    cost, place = NEAR
    alike = np.abs(one.p - other.p) <= place * np.abs(other.p)
    return bool(one.cost <= (1 + cost) * other.cost and alike.all())


def _by_cost(looks: Mapping[int, Look]) -> dict[int, Look]:
    return dict(sorted(looks.items(), key=lambda item: item[1].seen.cost))


def _look(task: Task, factors: tuple[float, ...], rest: tuple[float, ...], stop: Stop) -> Look:
    """A short descent at the smoothing ``factors``, to go on by those of ``rest``."""
    start = task.start
    solve = task.solve if factors == rest[-1:] else task.solve_widely
    seen = solve(start.p, start.x0, factors, stop)
    return Look(replace(start, p=seen.p, x0=task.with_ours(start.x0, seen.x0)), seen, rest)


def _sharpened(wide: Look, task: Task, narrowest: tuple[float, ...], stop: Stop) -> Look:
    """Where a short descent at the narrowest smoothing ended, from where that at the widest did. By every
    smoothing it goes on from the latter, which cost less there."""
    start = wide.start
    seen = task.solve(start.p, start.x0, narrowest, stop)
    if wide.seen.cost <= BLURRED * seen.cost:
        return Look(start, seen, wide.factors)
    return Look(replace(start, p=seen.p, x0=task.with_ours(start.x0, seen.x0)), seen, narrowest)


def _hopeful(look: Look, plan: Descent, fitted: Sequence[int] | None) -> bool:
    """Whether the cost is low enough where the short descent ended, or is promised to be."""
    if look.seen.cost <= plan.hopeful:
        return True
    counting = Task.of(look.start, plan.method, fitted).counting
    return look.seen.cost - promise(counting, look.seen.p, look.seen.x0) <= plan.hopeful


def _ended_early(look: Look, plan: Descent, stop: Stop, fitted: Sequence[int] | None) -> Result:
    """The short descent as a result; the other horizons' initial states are estimated until ``stop``."""
    task, seen = Task.of(look.start, plan.method, fitted), look.seen
    x0 = task.with_ours(look.start.x0, seen.x0)
    if task.theirs:
        handed = task.handed_on(seen.p, x0, plan.continuation[-1:], stop)
        x0 = run_on(look.start.problem, seen.p, handed)
    solution = replace(seen, status="ended early: it promises little", converged=False)
    return Result(look.start.problem, solution, x0, (seen.cost,), ended_early=True)
