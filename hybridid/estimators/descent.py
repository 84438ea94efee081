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
from dataclasses import replace

import numpy as np

from hybridid.estimators.one_start import Task, added, carried_to_the_end, carried_unless_lost
from hybridid.estimators.plan import Descent, Result, Start
from hybridid.estimators.screening import from_looks, from_the_best

Finer = Callable[[Result], Start | None]
"""Where to go on with shorter steps; None where those in use are short enough."""


def descend(starts: Iterable[Start], plan: Descent, fitted: Sequence[int] | None = None) -> Result:
    """The lowest cost that is reached from ``starts``, infinite if each start diverges.

    ``fitted`` are the numbers of the horizons that count (None: all). Of the others the initial states are
    estimated at the parameters found.
    """
    if plan.screening is not None:
        return from_the_best(starts, plan, plan.screening, fitted)
    results = [_carried(start, plan, fitted) for start in starts]
    costs = tuple(one.solution.cost for one in results)
    return replace(results[int(np.argmin(costs))], starts=costs)


def _carried(start: Start, plan: Descent, fitted: Sequence[int] | None) -> Result:
    """A start carried to the end, without the wide smoothings if these end above where it began."""
    factors = plan.continuation
    if len(factors) == 1 or not start.problem.widths:
        return carried_to_the_end(start, plan, factors, plan.handover, fitted)
    cost = Task.of(start, plan.method, fitted).cost(start.p, start.x0, factors[-1])
    return carried_unless_lost(start, plan, factors, fitted, start, cost)


def go_on(found: Result, plan: Descent, fitted: Sequence[int] | None = None) -> Result:
    """``found``, which ended early, carried to the end from where its short descents did; ``fitted`` as for
    ``descend``."""
    return replace(from_looks(found.looks, plan, fitted), diverged=found.diverged)


def refine(found: Result, plan: Descent, finer: Finer, fitted: Sequence[int] | None = None) -> Result:
    """``found``, or where the descent ends that goes on from it with as many steps a sample as ``finer`` asks
    for; ``fitted`` as for ``descend``. What ended early stays."""
    if found.ended_early:
        return found
    for _ in range(plan.refinement.times):
        start = finer(found)
        if start is None:
            break
        again = carried_to_the_end(start, plan, plan.continuation[-1:], plan.refinement.handover, fitted)
        if plan.refinement.must_hold and not np.isfinite(again.solution.cost):
            break
        solution = added(found.solution, again.solution, again.solution)
        found = replace(again, solution=solution, starts=found.starts, diverged=found.diverged)
    return found
