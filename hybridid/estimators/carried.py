"""Inner states of effects run on from one horizon to the next: nothing estimates them there.

A bristle's deflection or the load behind a spring is what the motion before has made it.
Freed at the start of every horizon it would be a force of its own choosing, with which any
effect that has a memory explains whatever a horizon lacks. So an inner state begins at
nothing with the record, or with what an output shows of it, and each further horizon takes
it from where the one before ended: ``Shooter`` hands it on.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from hybridid.estimators.problem import Problem

Array = NDArray[np.float64]


def carry(problem: Problem, p: Array, x0: Array) -> Array:
    """``x0`` (w, n_x) with each carried state as it is where its horizon begins: nothing with the record,
    else where the horizon before, if it is in ``problem``, left it; if it is not, as in ``x0``."""
    if carries_nothing(problem):
        return x0
    first = np.array([start == 0 for _, start, _ in problem.windows.origin])
    handed = np.where(problem.carried & first[:, None], 0.0, x0)
    begun = problem.shooter(handed, p).states[:, 0]
    return np.where(np.isfinite(begun), begun, handed)


def carries_nothing(problem: Problem) -> bool:
    """Whether no effect of the model has inner states that horizons hand on."""
    return not problem.carried.any()
