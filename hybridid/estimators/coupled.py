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
from scipy import linalg

from hybridid.estimators.normal_equations import small
from hybridid.estimators.problem import Problem
from hybridid.simulation.shooter import Shot

Array = NDArray[np.float64]
FORGOTTEN = 1e-4
"""Share of a horizon's own sensitivity below which an earlier initial state no longer counts."""
MOST = 1500
"""Initial states up to which the dense system pays."""
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
        gram, gradient = np.zeros((n + w * m, n + w * m)), np.zeros(n + w * m)
        residuals = problem.residuals(shot)
        for k, (by_p, by_x) in enumerate(_through(problem, shot)):
            used = problem.windows.used[k]
            columns = [np.arange(n), *(n + m * j + np.arange(m) for j in by_x)]
            blocks = [by_p * p_scale, *(block * x_scale for block in by_x.values())]
            rows = np.concatenate(blocks, axis=2)[used] / problem.scale[:, None]
            rows = rows.reshape(-1, rows.shape[2])
            at = np.concatenate(columns)
            gram[np.ix_(at, at)] += rows.T @ rows
            gradient[at] -= rows.T @ residuals[k][used].ravel()
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
        step = np.zeros(len(self.gradient))
        try:
            step[moving] = -linalg.solve(scaled, self.gradient[moving] / size, assume_a="pos") / size
        except linalg.LinAlgError:
            step[moving] = -np.linalg.lstsq(scaled, self.gradient[moving] / size, rcond=RIDGE)[0] / size
        return step[: self.count], step[self.count :].reshape(self.states)

    def predicted(self, dp: Array, dx: Array) -> float:
        """Decrease of the cost that the linear model promises for a step."""
        step = np.concatenate([dp, dx.ravel()])
        return -float(self.gradient @ step + 0.5 * step @ self.gram @ step)


def couples(problem: Problem) -> bool:
    """Whether horizons hand on inner states, and are few enough for this."""
    return bool(
        problem.carried.any()
        and max(problem.windows.follows) >= 0
        and problem.moving.any()
        and problem.moving.size <= MOST
    )


def _through(problem: Problem, shot: Shot) -> list[tuple[Array, dict[int, Array]]]:
    """For each horizon dy/dp (H, n_y, n), and dy/dx_j (H, n_y, m) of its own and of those earlier initial
    states that it still feels."""
    inner, n_x = problem.carried, shot.states.shape[2]
    own_states = np.where(problem.moving[:, None, None, :], shot.by_state, 0.0)
    by_p: list[Array] = [np.zeros((int(inner.sum()), shot.by_parameter.shape[3]))] * problem.windows.count
    by_x: list[dict[int, Array]] = [{}] * problem.windows.count
    found = []
    for k, before in enumerate(problem.windows.follows):
        through = shot.by_state[k][..., inner]
        shown: dict[int, Array] = {}
        if before >= 0 and np.isfinite(shot.ends_by[before]).all():
            ends = shot.ends_by[before][:, inner].T
            by_z = ends[:, :n_x][:, inner]
            own = np.where(problem.moving[before], ends[:, :n_x], 0.0)
            by_p[k] = ends[:, n_x:] + by_z @ by_p[before]
            earlier = {**{j: by_z @ block for j, block in by_x[before].items()}, before: own}
            shown = _felt({j: _chained(through, block) for j, block in earlier.items()}, own_states[k])
            by_x[k] = {j: earlier[j] for j in shown}
        found.append((shot.by_parameter[k] + _chained(through, by_p[k]), {**shown, k: own_states[k]}))
    return found


def _chained(through: Array, block: Array) -> Array:
    """``through`` (H, n_y, i) times ``block`` (i, m), in one product."""
    return (through.reshape(-1, len(block)) @ block).reshape(*through.shape[:2], -1)


def _felt(shown: dict[int, Array], own: Array) -> dict[int, Array]:
    """Of dy/dx_j those that still count beside what is the horizon's own."""
    least = FORGOTTEN * np.abs(own).max(axis=(0, 1))
    return {j: block for j, block in shown.items() if (np.abs(block).max(axis=(0, 1)) > least).any()}
