"""The end of a descent, scored on the held-out horizons."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from hybridid.estimators.plan import Result
from hybridid.estimators.problem import Problem
from hybridid.trace.horizons.score import Cells, Score, score_of
from hybridid.trace.horizons.split import Split

Array = NDArray[np.float64]


def scored(found: Result, split: Split) -> tuple[Score, Array]:
    """The score of a descent's end on the held-out horizons, and the RMSE (n_y,) on the fitted ones."""
    problem, p = found.problem, found.solution.p
    fitted, judged = problem.on(split.fitted), problem.on(split.held_out).estimating(())
    ours, ours_measured = _errors(fitted, p, found.solution.x0)
    theirs, theirs_measured = _errors(judged, p, found.x0[list(split.held_out)])
    score = score_of(ours, theirs, problem.scale, cells=(ours_measured, theirs_measured))
    return score, np.sqrt(sum((e**2).sum(axis=0) for e in ours) / fitted.windows.counts)


def _errors(problem: Problem, p: Array, x0: Array) -> tuple[list[Array], list[Cells]]:
    """Output errors of each horizon, (n_k, n_y), in the outputs' units: zero where they do not count; and
    which count."""
    r, windows = problem.residuals(problem.shooter(x0, p)) * problem.scale, problem.windows
    errors = [row[used] for row, used in zip(r, windows.used, strict=True)]
    return errors, [row[used] for row, used in zip(windows.cells, windows.used, strict=True)]
