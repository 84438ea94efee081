"""Normal equations of parameters and initial states together.

Their matrix has an arrow shape: every horizon's initial state meets only its own samples. A
step eliminates them by a Schur complement, so that it costs in proportion to the number of
horizons. Source: Björck (1996), Numerical Methods for Least Squares Problems, sec. 6.3.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
STATE_RIDGE = 1e-12
"""Keeps a direction that the data do not show (an unobserved inner state) from blowing up."""
RIDGE = 1e-20
"""The same for parameters, whose scales may be poor guesses: what is weakly seen still moves."""
LARGEST = 1e150
"""Square root of the largest number, about."""


@dataclass(frozen=True)
class Normal:
    """Blocks of the scaled Gauss-Newton normal equations at one point.

    ``pp`` (n, n), ``xx`` (w, m, m), ``xp`` (w, m, n); gradients ``gp`` (n,), ``gx`` (w, m).
    """

    pp: Array
    xx: Array
    xp: Array
    gp: Array
    gx: Array

    @property
    def finite(self) -> bool:
        """Whether every number is one, and small enough to be multiplied with another."""
        return small(self.pp, self.xx, self.xp, self.gp, self.gx)

    def holding(self, states: NDArray[np.bool_]) -> Normal:
        """The equations with the initial states in ``states`` (w, m) held where they are."""
        moving = np.where(states, 0.0, 1.0)
        return replace(
            self,
            xx=self.xx * moving[:, :, None] * moving[:, None, :],
            xp=self.xp * moving[..., None],
            gx=self.gx * moving,
        )

    def step(self, damping: float, fixed: NDArray[np.bool_]) -> tuple[Array, Array]:
        """The damped step (dp, dx), with the parameters in ``fixed`` held."""
        n = len(self.gp)
        pp = reduced = damped(self.pp, damping, RIDGE)
        right, dp = self.gp, np.zeros(n)
        stands = not self.xx.any()  # every initial state is known
        if not stands:
            xx = damped(self.xx, damping, STATE_RIDGE)
            solved = np.linalg.solve(xx, np.concatenate([self.xp, self.gx[..., None]], axis=2))
            inner_p, inner_g = solved[..., :n], solved[..., n]
            reduced = pp - np.einsum("wmi,wmj->ij", self.xp, inner_p)
            right = self.gp - np.einsum("wmi,wm->i", self.xp, inner_g)
        moving = ~fixed
        if moving.any():
            size = np.sqrt(np.diag(pp))[moving]
            block = reduced[np.ix_(moving, moving)] / np.outer(size, size)
            dp[moving] = np.linalg.lstsq(block, -right[moving] / size, rcond=1e-14)[0] / size
        return dp, np.zeros_like(self.gx) if stands else -(inner_g + np.einsum("wmn,n->wm", inner_p, dp))

    def of_parameters(self, dp: Array) -> float:
        """``dp' S dp`` of a step of the parameters that the initial states follow, S the Schur complement:
        over the variance of a sample's noise, the squared length of the step in standard errors."""
        xx = damped(self.xx, 0.0, STATE_RIDGE)
        across = self.xp @ dp
        followed = np.linalg.solve(xx, across[..., None])[..., 0]
        return float(dp @ self.pp @ dp - np.sum(across * followed))

    def predicted(self, dp: Array, dx: Array) -> float:
        """Decrease of the cost that the linear model promises for a step."""
        linear = self.gp @ dp + np.sum(self.gx * dx)
        cross = np.einsum("wm,wmn,n->", dx, self.xp, dp)
        square = dp @ self.pp @ dp + np.einsum("wm,wml,wl->", dx, self.xx, dx)
        return -float(linear + cross + 0.5 * square)


def small(*blocks: Array) -> bool:
    """Whether all are numbers below ``LARGEST``."""
    return all(block.min(initial=0.0) > -LARGEST and block.max(initial=0.0) < LARGEST for block in blocks)


def damped(matrix: Array, damping: float | Array, ridge: float) -> Array:
    """``matrix`` (..., n, n) plus ``damping`` times its diagonal and the share ``ridge`` of the largest entry
    there; a zero diagonal becomes one."""
    diagonal = np.einsum("...ii->...i", matrix)
    floor = ridge * diagonal.max(axis=-1, keepdims=True, initial=0.0)
    floor = np.where(floor > 0, floor, 1.0)
    return matrix + (damping * diagonal + floor)[..., None] * np.eye(matrix.shape[-1])
