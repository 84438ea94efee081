"""Which channels a record itself confirms: there is no need to try another sign, unit or column for them.

A model whose input has the wrong sign pushes the wrong way: what the input does in it is opposite to what the
record shows, and leaving the input out makes the error no larger. So a fit in which leaving an input out at
least doubles the squared error, stretch by stretch, has that input right, in sign and in size. An output is
right if it loses as much where all inputs are left out. The initial states follow, to first order.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from hybridid.estimators.problem import Problem
from hybridid.quality.trial import Data, explains, stretches
from hybridid.simulation.shooter import Shot

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Doubt:
    """Whether each input (n_u,) and each output (n_y,) is in doubt."""

    inputs: NDArray[np.bool_]
    outputs: NDArray[np.bool_]

    @property
    def channels(self) -> NDArray[np.bool_]:
        """Those of the inputs, then those of the outputs."""
        return np.concatenate([self.inputs, self.outputs])


def doubt_of(data: Data, p: Array, x0: Array) -> Doubt:
    """The channels that a fit which ended at ``p`` (n_p,), ``x0`` (w, n_x) does not confirm; all if it
    diverges there."""
    problem = data.problem
    n_u, n_y = problem.windows.inputs.shape[2], len(problem.scale)
    shot = problem.shooter(x0, p, sensitivities=True)
    own = problem.residuals(shot)
    if not (np.isfinite(own).all() and np.isfinite(shot.by_state).all()):
        return Doubt(np.ones(n_u, dtype=bool), np.ones(n_y, dtype=bool))
    left = partial(_left, problem, p, x0, _basis(problem, shot))
    without = [left(np.arange(n_u) != k) for k in range(n_u)]
    driven = left(np.zeros(n_u, dtype=bool))
    used = problem.windows.used
    inputs = [not _confirmed(own, other, used) for other in without]
    outputs = [not _confirmed(own[..., [k]], driven[..., [k]], used) for k in range(n_y)]
    return Doubt(np.array(inputs), np.array(outputs))


def _confirmed(own: Array, without: Array, used: NDArray[np.bool_]) -> bool:
    ours, theirs = stretches(own, used), stretches(without, used)
    return explains((ours.mean(), ours), (np.nan_to_num(theirs.mean(), nan=np.inf), theirs))


def _left(problem: Problem, p: Array, x0: Array, basis: Array, kept: NDArray[np.bool_]) -> Array:
    """The residual (w, H, n_y) with only the inputs ``kept`` (n_u,) at work, less what the initial states
    take."""
    w = problem.windows
    stages = w.stages * np.tile(kept, w.stages.shape[2] // max(len(kept), 1))  # a free swing has no input
    windows = replace(w, stages=stages, inputs=w.inputs * kept)
    residual = problem.residuals(problem.shooter.over(windows)(x0, p))
    flat = np.where(np.isfinite(residual), residual, 0.0).reshape(len(residual), -1, 1)
    rest: Array = flat - basis @ (basis.swapaxes(1, 2) @ flat)
    return np.where(np.isfinite(residual), rest.reshape(residual.shape), np.inf)


def _basis(problem: Problem, shot: Shot) -> Array:
    """Orthonormal basis (w, H n_y, n_x) of what the initial states of each horizon can take."""
    used = problem.windows.cells[..., None]
    by_state = np.where(used, shot.by_state / problem.scale[:, None], 0.0)
    tall = by_state.reshape(len(by_state), -1, by_state.shape[3])
    size = np.linalg.norm(tall, axis=1, keepdims=True)
    basis, _ = np.linalg.qr(tall / np.where(size > 0, size, 1.0))
    return np.where(size > 0, basis, 0.0)
