"""Normal equations where horizons hand inner states on: each initial state meets later horizons too.

The inner states z in which horizon k begins are those in which k - 1 ended, so its outputs depend on the
parameters and on the initial states x_j of the horizons before it:

    dy_k/dp = y_p + y_z dz_k/dp,      dz_k/dp = z_p + z_z dz_(k-1)/dp,
    dy_k/dx_j = y_z dz_k/dx_j,        dz_k/dx_j = z_z dz_(k-1)/dx_j,      dz_k/dx_(k-1) = z_x,

with the derivatives of horizon k's outputs, and of the end of k - 1, by what is its own. Left out, a fit
creeps: a load behind a spring swings on for many horizons.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import lapack

from hybridid.estimators.jacobian import of_each
from hybridid.estimators.normal_equations import small
from hybridid.estimators.problem import Problem
from hybridid.simulation.shooter import Shot

Array = NDArray[np.float64]
FORGOTTEN = 1e-4
"""Share of the norm of a horizon's own sensitivity below which an earlier initial state no longer counts."""
RIDGE = 1e-14
"""Of the scaled matrix: what no sample shows stays where it is."""


@dataclass(frozen=True)
class Coupled:
    """Scaled Gauss-Newton normal equations ``gram`` (n + w m, n + w m), ``gradient`` (n + w m,) of ``count``
    parameters and the initial states (w, m). As ``normal_equations.Normal``, without its arrow shape."""

    gram: Array
    gradient: Array
    count: int
    states: tuple[int, int]

    @classmethod
    def of(cls, problem: Problem, shot: Shot, p_scale: Array, x_scale: Array) -> Coupled:
        """From a shot with sensitivities; steps count in ``p_scale`` (n,) and ``x_scale`` (m,)."""
        w, m, n = problem.windows.count, len(x_scale), len(p_scale)
        square, error = of_each(problem, shot)
        begins = _handed_on(problem, shot, square)
        along = np.tile(np.eye(m + n), (w, 1, 1))
        along[:, np.flatnonzero(problem.carried), m:] += begins[..., :n]
        square, error = along.swapaxes(1, 2) @ square @ along, (error[:, None] @ along)[:, 0]
        matrix, error = _together(problem, square, error, begins[..., n:])
        places = np.concatenate([np.arange(n), n + np.flatnonzero(problem.moving)])
        scale = np.concatenate([p_scale, np.tile(x_scale, w)])[places]
        gram, gradient = np.zeros((n + w * m, n + w * m)), np.zeros(n + w * m)
        gram[np.ix_(places, places)] = matrix * np.outer(scale, scale)
        gradient[places] = -error * scale
        return cls(gram, gradient, n, (w, m))

    @property
    def finite(self) -> bool:
        """Whether every number is one, and small enough to be multiplied with another."""
        return small(self.gram, self.gradient)

    @property
    def gp(self) -> Array:
        """Gradient by the parameters, (n_p,)."""
        return self.gradient[: self.count]

    @property
    def gx(self) -> Array:
        """Gradient by the initial states, (w, m)."""
        return self.gradient[self.count :].reshape(self.states)

    def holding(self, states: NDArray[np.bool_]) -> Coupled:
        """The equations with the initial states in ``states`` (w, m) held where they are."""
        moving = np.concatenate([np.ones(self.count), np.where(states, 0.0, 1.0).ravel()])
        return replace(self, gram=self.gram * moving[:, None] * moving, gradient=self.gradient * moving)

    def step(self, damping: float, fixed: NDArray[np.bool_]) -> tuple[Array, Array]:
        """The damped step (dp, dx), with the parameters in ``fixed`` held."""
        size = np.sqrt(np.diag(self.gram))
        moving = size > 0
        moving[: self.count] &= ~fixed
        size = size[moving]
        scaled = self.gram[np.ix_(moving, moving)] / np.outer(size, size)
        scaled[np.diag_indices_from(scaled)] = 1.0 + damping + RIDGE
        right, step = self.gradient[moving] / size, np.zeros(len(self.gradient))
        if moving.any():
            _, solved, indefinite = lapack.dposv(scaled, right)
            step[moving] = -(np.linalg.lstsq(scaled, right, rcond=RIDGE)[0] if indefinite else solved) / size
        return step[: self.count], step[self.count :].reshape(self.states)

    def predicted(self, dp: Array, dx: Array) -> float:
        """Decrease of the cost that the linear model promises for a step."""
        step = np.concatenate([dp, dx.ravel()])
        return -float(self.gradient @ step + 0.5 * step @ self.gram @ step)


def _handed_on(problem: Problem, shot: Shot, square: Array) -> Array:
    """dz_k/dp and dz_k/dx_j (w, i, n + w e) of the i inner states in which each horizon begins, by the n
    parameters and by the e estimated initial states of each earlier horizon that it still feels, else zero.
    ``square`` (w, m + n, m + n) are the products J'J by each horizon's own."""
    own, inner = problem.moving[0], problem.carried
    w, m = square.shape[0], len(own)
    i, e, n = int(inner.sum()), int(own.sum()), square.shape[1] - m
    found = np.zeros((w, i, n + w * e))
    by_x = found[:, :, n:].reshape(w, i, w, e)
    whole: NDArray[np.bool_] = np.all(np.isfinite(shot.ends_by), axis=(1, 2))
    ends = shot.ends_by[..., inner].swapaxes(1, 2)
    end_by_z, end_by_x = ends[:, :, :m][..., inner], ends[:, :, :m][..., own]
    places = np.flatnonzero(inner)
    through = square[:, places[:, None], places]
    faint = FORGOTTEN**2 * np.diagonal(square, axis1=1, axis2=2)[:, :m][:, own]
    for k, before in enumerate(problem.windows.follows):
        if before < 0 or not whole[before]:
            continue
        np.matmul(end_by_z[before], found[before], out=found[k])
        found[k, :, :n] += ends[before, :, m:]
        by_x[k, :, before] = end_by_x[before]
        past = np.flatnonzero(by_x[k].any(axis=(0, 2)))
        block = by_x[k][:, past].reshape(i, len(past) * e)
        shown = ((through[k] @ block) * block).sum(axis=0).reshape(len(past), e)
        felt = (shown > faint[k]).any(axis=1)
        by_x[k][:, past[~felt]] = 0.0
    return found


def _together(problem: Problem, square: Array, error: Array, earlier: Array) -> tuple[Array, Array]:
    """J'J (n + w e, n + w e) and J'r (n + w e,) by the parameters and all estimated initial states.

    Made of each horizon's own, ``square`` (w, m + n, m + n) and ``error`` (w, m + n), in whose columns by the
    parameters dz_k/dp is included, and of dz_k/dx_j ``earlier`` (w, i, w e)."""
    w, m = problem.moving.shape
    n, e = square.shape[1] - m, int(problem.moving[0].sum())
    none = np.zeros(n, dtype=bool)
    own, inner = np.append(problem.moving[0], none), np.append(problem.carried, none)
    through, to_own = square[:, inner], square[:, own]
    tall = earlier.reshape(-1, w * e)
    later = (to_own[:, :, inner] @ earlier).reshape(w * e, w * e)
    xx = tall.T @ (through[:, :, inner] @ earlier).reshape(tall.shape) + later + later.T
    each = np.arange(w)
    xx.reshape(w, e, w, e)[each, :, each] += to_own[:, :, own]
    xp = tall.T @ through[:, :, m:].reshape(len(tall), n) + to_own[:, :, m:].reshape(w * e, n)
    gx = tall.T @ error[:, inner].ravel() + error[:, own].ravel()
    matrix = np.block([[square[:, m:, m:].sum(axis=0), xp.T], [xp, xx]])
    return matrix, np.concatenate([error[:, m:].sum(axis=0), gx])
