"""Of several starts one is carried on: a short descent from each shows which, and whether it is worth it."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace

import numpy as np

from hybridid.estimators.carried import run_on
from hybridid.estimators.one_start import Task, carried_to_the_end
from hybridid.estimators.plan import Descent, Look, Result, Start
from hybridid.estimators.reduced import promise
from hybridid.estimators.stop import Stop

BLURRED = 1.5**2
"""Ratio of the costs at the widest and the narrowest smoothing above which the records refute the wide one: a
descent there would fit the error of the smoothing."""


def from_the_best(starts: Iterable[Start], plan: Descent, stop: Stop, fitted: Sequence[int] | None) -> Result:
    """Of ``starts`` the one from which a short descent, until ``stop``, gets farthest, carried to the end if
    it is hopeful; if it diverges, the next one."""
    looks = [_look(start, plan, stop, fitted) for start in starts]
    diverged = tuple(k for k, one in enumerate(looks) if not np.isfinite(one.seen.cost))
    looks.sort(key=lambda one: one.seen.cost)
    if np.isfinite(looks[0].seen.cost) and not _hopeful(looks[0], plan, fitted):
        ended = _ended_early(looks[0], plan, stop, fitted)
        return replace(ended, diverged=diverged, looks=tuple(looks))
    return replace(from_looks(looks, plan, fitted), diverged=diverged)


def from_looks(looks: Sequence[Look], plan: Descent, fitted: Sequence[int] | None) -> Result:
    """The first of ``looks`` that does not diverge, carried to the end."""
    costs: list[float] = []
    for look in looks:
        found = carried_to_the_end(look.start, look.rest_of(plan), look.factors, plan.handover, fitted)
        costs.append(found.solution.cost)
        if np.isfinite(costs[-1]):
            break
    return replace(found, starts=tuple(costs))


def _look(start: Start, plan: Descent, stop: Stop, fitted: Sequence[int] | None) -> Look:
    """A short descent at the widest smoothing, then one at the narrowest, if anything is smoothed."""
    task = Task.of(start, plan.method, fitted)
    widest, narrowest = plan.continuation[:1], plan.continuation[-1:]
    wide = task.solve(start.p, start.x0, widest, stop)
    seen, factors = wide, plan.continuation
    if widest != narrowest and start.problem.widths:
        seen = task.solve(wide.p, task.with_ours(start.x0, wide.x0), narrowest, stop)
        factors = narrowest if wide.cost > BLURRED * seen.cost else factors
    return Look(replace(start, p=seen.p, x0=task.with_ours(start.x0, seen.x0)), seen, factors)


def _hopeful(look: Look, plan: Descent, fitted: Sequence[int] | None) -> bool:
    """Whether the cost is low enough where the short descent ended, or is promised to be."""
    if look.seen.cost <= plan.hopeful:
        return True
    counting = Task.of(look.start, plan.method, fitted).counting
    return look.seen.cost - promise(counting, look.seen.p, look.seen.x0) <= plan.hopeful


def _ended_early(look: Look, plan: Descent, stop: Stop, fitted: Sequence[int] | None) -> Result:
    """The short descent as a result; the other horizons' initial states are estimated until ``stop``."""
    task, seen, x0 = Task.of(look.start, plan.method, fitted), look.seen, look.start.x0
    if task.theirs:
        handed = task.handed_on(seen.p, x0, plan.continuation[-1:], stop)
        x0 = run_on(look.start.problem, seen.p, handed)
    solution = replace(seen, status="ended early: it promises little", converged=False)
    return Result(look.start.problem, solution, x0, (seen.cost,), ended_early=True)
