"""Over which horizons a fit does not depend on the smoothing of sign(v).

With sign(v) smoothed, a reversal is simulated a moment too early or too late. Every later reversal of the
same run moves with it. So in a long run the outputs can depend on the width of the smoothing, and the
estimates with them. Over shorter horizons, each from an initial state of its own, the difference has no time
to grow. Source: Ribeiro, Tiels, Umenberger, Schön, Aguirre (2020), "On the smoothness of nonlinear system
identification", Automatica 121, 109158.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from hybridid.estimators.estimate import Estimate
from hybridid.estimators.problem import Problem, paths
from hybridid.estimators.uncertainty import uncertainty
from hybridid.simulation.windows import cut

Array = NDArray[np.float64]
TRIED = (1000, 500, 200, 100, 50)
"""Samples of the horizons that are tried, the longest first."""
LITTLE = 0.1
"""Share of what the fit leaves that the smoothing may change, where the records do not tell the noise."""


def steady_horizon(problem: Problem, estimate: Estimate) -> int | None:
    """Samples of the longest horizon over which the smoothing changes each output by less than the sensor's
    noise (or ``LITTLE`` of what the fit leaves); None if none of those tried is so short."""
    p = problem.model.values(estimate.values)
    limit = [one.noise if np.isfinite(one.noise) else LITTLE * one.rmse for one in estimate.left]
    path = paths(problem, p, estimate.initial_states)
    longest = max(problem.windows.lengths)
    for samples in (n for n in TRIED if 2 * n <= longest):
        shorter, x0 = _over(problem, samples, path)
        if (uncertainty(shorter, p, x0).smeared <= limit).all():
            return samples
    return None


def _over(problem: Problem, samples: int, path: list[Array]) -> tuple[Problem, Array]:
    """``problem`` over horizons of so many ``samples``, and their initial states (w, n_x) on ``path``."""
    windows = cut(problem.records, samples, problem.windows.substeps)
    shooter = problem.shooter.over(windows)
    shorter = replace(problem, windows=windows, shooter=shooter, estimate_x0=True, weights=None)
    return shorter, np.stack([path[record][start] for record, start, _ in windows.origin])
