"""Inner states of effects continue from one horizon to the next; they are not estimated at each start.

A bristle's deflection, or the position of a load behind a spring, follows from the motion before.
Estimated anew for every horizon, it would be a free force, and any effect with a memory could
explain any error. So an inner state is zero where the record begins, or what an output shows of
it. Each further horizon takes it from the end of the one before: ``Shooter`` hands it on.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from hybridid.estimators.problem import Problem
from hybridid.simulation.shooter import Shot

Array = NDArray[np.float64]
UNFELT = 1e-9
"""Sensitivity of the outputs, against the largest, that is rounding alone."""
PASSES = 2
"""Over the record: a direction that decays unfelt lands where it should with the second."""


def carry(problem: Problem, p: Array, x0: Array) -> Array:
    """``x0`` (w, n_x) with each carried state as it is where its horizon begins: with the record, or after a
    masked stretch that is not simulated, nothing or the input there; else where the horizon before, if it is
    in ``problem``, left it; if it is not, as in ``x0``."""
    if carries_nothing(problem):
        return x0
    first = np.array(problem.windows.is_head)
    handed = np.where(problem.carried & first[:, None], problem.measured_x0(), x0)
    begun = problem.shooter(handed, p).states[:, 0]
    return np.where(np.isfinite(begun), begun, handed)


def run_on(problem: Problem, p: Array, x0: Array) -> Array:
    """``x0`` (w, n_x) whose unobservable part continues from horizon to horizon.

    Outputs that are velocities do not depend on the position. The initial position of a horizon is then
    arbitrary, but an effect that depends on position needs one continuous path through the record. The
    directions on which no output depends (the null space of dy/dx0) are continued, the others stay.
    """
    if not any(s.observed_by is None for s in problem.model.plant.states) or not problem.estimate_x0:
        return x0
    scale = np.array([state.scale for state in problem.model.states])
    felt = problem.shooter(x0, p, sensitivities=True).by_state * scale
    felt = felt[problem.windows.used].reshape(-1, len(scale))
    if not np.isfinite(felt).all():
        return x0
    size, directions = np.linalg.svd(felt, full_matrices=False)[1:]
    unfelt = directions[(size <= UNFELT * size[0])]
    x0 = np.array(x0)
    for _ in range(PASSES if len(unfelt) else 0):
        ends = problem.shooter(x0, p).ends(problem.windows)
        moved = np.zeros_like(x0)
        for k, before in enumerate(problem.windows.follows):
            if before >= 0:
                gap = (ends[before] + moved[before] - x0[k]) / scale
                moved[k] = (unfelt.T @ (unfelt @ gap)) * scale
        x0 += np.where(problem.carried, 0.0, moved)
    return x0


def by_parameter(problem: Problem, shot: Shot) -> Array:
    """dy/dp (w, H, n_y, n_free) with all that comes along from the horizons before.

    The inner states z in which horizon k begins depend on the parameters as those in which k - 1 ended,

        dz_k/dp = z_p + z_z dz_(k-1)/dp + z_x dx_(k-1)/dp,    dx/dp = -(X'X)^-1 X' dy/dp,

    the derivatives of the end of k - 1 by p, its own inner and its estimated initial states x, which follow
    the parameters so that they fit their own horizon (X = dy/dx): variable projection. It costs in proportion
    to the number of horizons, where ``coupled`` keeps every pair of them. Source: Golub, Pereyra (1973),
    SIAM J. Numer. Anal. 10(2), 413-432.
    """
    if carries_nothing(problem):
        return shot.by_parameter
    n_x, inner, used = shot.states.shape[2], problem.carried, problem.windows.used
    total = np.array(shot.by_parameter)
    arriving = np.zeros((problem.windows.count, int(inner.sum()), total.shape[3]))
    for k, before in enumerate(problem.windows.follows):
        if before >= 0 and np.isfinite(shot.ends_by[before]).all():
            moving = problem.moving[before]
            own, ends = used[before], shot.ends_by[before][:, inner].T
            by_x = shot.by_state[before][own][..., moving] / problem.scale[:, None]
            by_p = total[before][own] / problem.scale[:, None]
            counted = problem.windows.cells[before][own][..., None].astype(float)
            if problem.weights is not None:
                counted = counted * problem.weights[before][own][..., None]
            by_x, by_p = by_x * counted, by_p * counted
            following = -_fitted(by_x, by_p)
            by_state, by_p = ends[:, :n_x], ends[:, n_x:]
            arriving[k] = by_p + by_state[:, inner] @ arriving[before] + by_state[:, moving] @ following
        with np.errstate(over="ignore", invalid="ignore"):  # sensitivities that grow without end
            total[k] += shot.by_state[k][..., inner] @ arriving[k]
    return total


def _fitted(x: Array, y: Array) -> Array:
    """``(X'X)^-1 X' Y`` of (h, n_y, m) and (h, n_y, n), blind to what no sample shows."""
    tall_x, tall_y = (a.reshape(a.shape[0] * a.shape[1], a.shape[2]) for a in (x, y))
    if not (np.isfinite(tall_x).all() and np.isfinite(tall_y).all()):
        return np.zeros((x.shape[2], y.shape[2]))
    size = np.linalg.norm(tall_x, axis=0)
    size = np.where(size > 0, size, 1.0)[:, None]
    return np.linalg.lstsq(tall_x / size.T, tall_y, rcond=1e-9)[0] / size


def carries_nothing(problem: Problem) -> bool:
    """Whether no effect of the model has inner states that horizons hand on."""
    return not problem.carried.any()
