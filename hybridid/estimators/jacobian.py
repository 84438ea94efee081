"""The Jacobian J of a problem's weighted outputs, column by column, and its products J'J and J'r.

All normal equations are made of these products, one small matrix a horizon. A column that lies in one piece
is scaled and multiplied several times faster than one spread over an array of samples by parameters.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from hybridid.estimators.problem import Problem
from hybridid.simulation.shooter import Shot

Array = NDArray[np.float64]


def columns(problem: Problem, by_state: Array, by_parameter: Array) -> Array:
    """J (w, n_x + n, n_y H) of dy/dx0 (w, H, n_y, n_x) and dy/dp (w, H, n_y, n): divided by the outputs'
    scales and weighted, zero where an output does not count."""
    w, length, n_y, n_x = by_state.shape
    found = np.empty((w, n_x + by_parameter.shape[3], n_y, length))
    found[:, :n_x] = by_state.transpose(0, 3, 2, 1)
    found[:, n_x:] = by_parameter.transpose(0, 3, 2, 1)
    with np.errstate(over="ignore"):
        found *= 1.0 / problem.scale[:, None]
        if problem.weights is not None:
            found *= problem.weights.transpose(0, 2, 1)[:, None]
    for k in np.flatnonzero(~problem.windows.cells.all(axis=(1, 2))):
        # what lies beyond a record's end may have left the range of numbers
        found[k][:, ~problem.windows.cells[k].T] = 0.0
    return found.reshape(*found.shape[:2], n_y * length)


def products(problem: Problem, shot: Shot, by: Array) -> tuple[Array, Array]:
    """J'J (w, q, q) and J'r (w, q) of each horizon: J the columns ``by`` (w, q, n_y H), r the residuals
    of ``shot``."""
    error = problem.residuals(shot).swapaxes(1, 2).reshape(len(by), -1, 1)
    with np.errstate(over="ignore", invalid="ignore"):
        return by @ by.swapaxes(1, 2), (by @ error)[..., 0]


def of_each(problem: Problem, shot: Shot) -> tuple[Array, Array]:
    """J'J (w, q, q) and J'r (w, q) of each horizon, by its own initial state and the parameters."""
    if shot.multiplied:
        return shot.square, shot.error
    return products(problem, shot, columns(problem, shot.by_state, shot.by_parameter))
