"""A trial step that fails in a few horizons is mended there, not given up everywhere.

Dry friction makes the cost of a horizon rough in its initial state: a hidden part that sticks a moment longer
moves all that follows. One damping for all horizons grows until the roughest of them is content, and the
parameters stand still. So where a trial step fails, the horizons whose cost rose seek their initial states by
themselves (``separate``), at the parameters of the trial and from where they were. The others keep the step.
With nested minimisation over the initial states of a horizon this is a step of variable projection; source:
Golub, Pereyra (2003), Inverse Problems 19, R1-R26.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from hybridid.estimators.carried import carries_nothing
from hybridid.estimators.problem import Problem
from hybridid.estimators.reduced import LeastSquares
from hybridid.estimators.separate import solve_separately
from hybridid.estimators.stop import Stop
from hybridid.simulation.shooter import Shot

Array = NDArray[np.float64]
POOR = 0.25
"""Share of the promised decrease of the cost below which a trial step is mended, and which the mended step
must gain: one that gains less wants a shorter step of the parameters."""
SHORT = Stop(3, 1e-6)
"""A horizon only has to get below the cost that it had."""


def has_own_states(problem: Problem) -> bool:
    """Whether there are several horizons with initial states of their own to be found."""
    return problem.windows.count > 1 and bool(problem.moving.any()) and carries_nothing(problem)


def mended(
    problem: Problem, now: tuple[Array, Shot], tried: tuple[Array, Shot], p: Array, enough: float
) -> tuple[Array, Shot]:
    """Initial states (w, n_x) at the parameters ``p`` (n_p,) of a trial, with their shot: better ones where
    the cost of a horizon rose, if that brings the whole cost below ``enough``; else those ``tried``. ``now``
    and ``tried`` are such pairs."""
    (x0, here), (x, there) = now, tried
    before, after = problem.costs(here), problem.costs(there)
    worse = np.flatnonzero(~(after <= before))
    if after.sum() < enough or not 0 < len(worse) < len(before):
        return tried
    apart = problem.on(worse.tolist()).estimating(())
    found = solve_separately(LeastSquares.of(apart), p, x0[worse], SHORT).x0
    left = apart.costs(apart.shooter(found, p))
    better = left < after[worse]
    after[worse[better]] = left[better]
    if not after.sum() < enough:
        return tried
    mixed = np.array(x)
    mixed[worse[better]] = found[better]
    return mixed, problem.shot(mixed, p, sensitivities=there.sensitive)
