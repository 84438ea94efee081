"""Inner states of effects run on from one horizon to the next: nothing estimates them there.

A bristle's deflection or the load behind a spring is what the motion before has made it.
Freed at the start of every horizon it would be a force of its own choosing, with which any
effect that has a memory explains whatever a horizon lacks. So an inner state begins at
nothing with the record, or with what an output shows of it, and each further horizon takes
it from where the one before ended.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from hybridid.estimators.problem import Problem

Array = NDArray[np.float64]
PASSES = 3
"""Rounds of handing on: a state that outlives three horizons is handed on with a small error."""


def carry(problem: Problem, p: Array, x0: Array) -> Array:
    """``x0`` (w, n_x) with each carried state where the horizon before left it.

    ``problem`` must hold every horizon of its records.
    """
    if carries_nothing(problem):
        return x0
    follows = _follows(problem)
    handed = np.array(x0)
    handed[:, problem.carried] = 0.0
    for _ in range(PASSES):
        ends = problem.shooter(handed, p).ends(problem.windows)
        known = [bool(np.isfinite(end).all()) for end in ends]
        for k, before in enumerate(follows):
            if before is not None and known[before]:
                handed[k] = np.where(problem.carried, ends[before], handed[k])
    return handed


def carries_nothing(problem: Problem) -> bool:
    """Whether no effect of the model has inner states that horizons hand on."""
    return not problem.carried.any()


def _follows(problem: Problem) -> list[int | None]:
    """For each horizon the number of the one that ends where it begins."""
    ends = {(record, stop): k for k, (record, _, stop) in enumerate(problem.windows.origin)}
    return [ends.get((record, start)) for record, start, _ in problem.windows.origin]
