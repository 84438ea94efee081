"""A start from short horizons, for plants whose states no regression can see.

Over a whole record a model with poor parameters is soon far from where the machine was, and the
cost has valleys of its own there. Over a short horizon, from an initial state that is free to
fit, it stays near, and the cost is nearly quadratic. Source: Ribeiro, Tiels, Umenberger, Schön,
Aguirre (2020), "On the smoothness of nonlinear system identification", Automatica 121, 109158.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from hybridid.estimators.method import GAUSS_NEWTON, Method
from hybridid.estimators.problem import Problem
from hybridid.estimators.start import best_initial_states, x0_candidates
from hybridid.estimators.stop import Stop, Watch
from hybridid.simulation.windows import cut

Array = NDArray[np.float64]
SHORT = 100
"""Samples of a short horizon."""
LOOSE = Stop(30, 1e-3)
"""It only leads to the fit proper."""


def short_horizon_problem(problem: Problem) -> Problem | None:
    """The problem over short horizons; None where it is no help: every state of the plant is seen
    through an output, or the horizons are short already."""
    seen = all(state.observed_by is not None for state in problem.model.plant.states)
    if seen or problem.windows.length <= 2 * SHORT:
        return None
    windows = cut(problem.records, SHORT, problem.windows.substeps)
    shooter = replace(problem.shooter, windows=windows)
    return replace(problem, windows=windows, shooter=shooter, estimate_x0=True)


def short_horizon_start(
    problem: Problem, p: Array, factor: float, watch: Watch | None = None, method: Method = GAUSS_NEWTON
) -> Array:
    """Parameters (n_p,) from the short-horizon ``problem``, started at ``p`` with sign(v) smoothed by
    ``factor``; ``p`` itself if that diverges."""
    x0 = best_initial_states(problem, p, x0_candidates(problem, p))
    found = method.solve(problem, p, x0, (factor,), LOOSE, watch)
    return problem.smoothed(found.p, 1.0) if np.isfinite(found.cost) else p
