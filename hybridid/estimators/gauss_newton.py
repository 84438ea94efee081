"""Levenberg-Marquardt on parameters and initial states together.

The normal matrix has an arrow shape: every horizon's initial state meets only its own
samples. Each step eliminates them by a Schur complement, so that the cost of a step
grows linearly with the number of horizons. Source: Björck (1996), Numerical Methods for
Least Squares Problems, sec. 6.3 and 9.2; damping by Nielsen (1999), IMM-REP-1999-05.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from hybridid.estimators.estimate import Solution
from hybridid.estimators.problem import Problem

Array = NDArray[np.float64]
RIDGE = 1e-12
"""Keeps a direction that the data do not show (an unobserved inner state) from blowing up."""
MOST_DAMPING = 1e12
LOOSE = 1e-4
"""Tolerance of the descents at coarser smoothing, which only lead to the next."""
SLOW_STEPS, SLOW_GAIN = 10, 1e-3
"""Stick and slip make the cost of long horizons rough: descent then creeps from kink to kink."""


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

    def step(self, damping: float, fixed: NDArray[np.bool_]) -> tuple[Array, Array]:
        """The damped step (dp, dx), with the parameters in ``fixed`` held."""
        n = len(self.gp)
        xx = _damped(self.xx, damping)
        solved = np.linalg.solve(xx, np.concatenate([self.xp, self.gx[..., None]], axis=2))
        inner_p, inner_g = solved[..., :n], solved[..., n]
        reduced = _damped(self.pp, damping) - np.einsum("wmi,wmj->ij", self.xp, inner_p)
        right = self.gp - np.einsum("wmi,wm->i", self.xp, inner_g)
        dp = np.zeros(n)
        moving = ~fixed
        if moving.any():
            block = reduced[np.ix_(moving, moving)]
            dp[moving] = np.linalg.lstsq(block, -right[moving], rcond=1e-14)[0]
        return dp, -(inner_g + np.einsum("wmn,n->wm", inner_p, dp))

    def predicted(self, dp: Array, dx: Array) -> float:
        """Decrease of the cost that the linear model promises for a step."""
        linear = self.gp @ dp + np.sum(self.gx * dx)
        cross = np.einsum("wm,wmn,n->", dx, self.xp, dp)
        square = dp @ self.pp @ dp + np.einsum("wm,wml,wl->", dx, self.xx, dx)
        return -float(linear + cross + 0.5 * square)


def _damped(matrix: Array, damping: float) -> Array:
    diagonal = np.einsum("...ii->...i", matrix)
    floor = RIDGE * diagonal.max(axis=-1, keepdims=True, initial=0.0)
    floor = np.where(floor > 0, floor, 1.0)
    return matrix + (damping * diagonal + floor)[..., None] * np.eye(matrix.shape[-1])


def solve(
    problem: Problem,
    p: Array,
    x0: Array,
    factors: Sequence[float] = (1.0,),
    max_iterations: int = 100,
    tolerance: float = 1e-6,
    watch: Callable[[int, float], None] | None = None,
) -> Solution:
    """Minimise the problem's cost from ``p`` (n_p,), ``x0`` (w, n_x), inside the bounds.

    ``factors`` multiply the smoothing velocities, one descent each. Converged means that a
    full Gauss-Newton step promises a relative decrease of the cost below ``tolerance``, or
    that the last ``SLOW_STEPS`` steps together gained less than ``SLOW_GAIN``.
    """
    scaling = _Scaling.of(problem)
    begun = 0
    for k, factor in enumerate(factors):
        last = k == len(factors) - 1
        counted = _from(watch, begun)
        found = _descend(
            problem, scaling, problem.smoothed(p, factor), x0, max_iterations, tolerance if last else LOOSE, counted
        )
        p, x0, begun = found.p, found.x0, begun + found.iterations
    return replace(found, iterations=begun)


def _from(watch: Callable[[int, float], None] | None, begun: int) -> Callable[[int, float], None]:
    """``watch`` counting on from ``begun`` iterations."""
    return lambda iteration, cost: watch(begun + iteration, cost) if watch else None


def _descend(
    problem: Problem,
    scaling: _Scaling,
    p: Array,
    x0: Array,
    max_iterations: int,
    tolerance: float,
    watch: Callable[[int, float], None],
) -> Solution:
    """One Levenberg-Marquardt descent at one smoothing."""
    p, x0 = scaling.inside(p), np.array(x0)
    cost = problem.cost(problem.shooter(x0, p))
    if not np.isfinite(cost):
        return Solution(p, x0, np.inf, "the simulation diverges at the start", False, 0)
    damping, growth, history = 1e-4, 2.0, [cost]
    for iteration in range(1, max_iterations + 1):
        normal = _linearise(problem, scaling, p, x0)
        held = scaling.held(p, normal.gp)
        if _promises_little(normal, held, cost, tolerance):
            return Solution(p, x0, cost, "converged", True, iteration - 1, tuple(history))
        while True:
            dp, dx = normal.step(damping, held)
            trial_p, trial_x = scaling.move(p, x0, dp, dx)
            promised = normal.predicted(*scaling.between(p, x0, trial_p, trial_x))
            trial = problem.cost(problem.shooter(trial_x, trial_p))
            ratio = (cost - trial) / promised if promised > 0 else -1.0
            if np.isfinite(trial) and ratio > 0:
                break
            damping, growth = damping * growth, growth * 2
            if damping > MOST_DAMPING:
                return Solution(p, x0, cost, "stalled: no step lowers the cost", False, iteration, tuple(history))
        damping *= max(1 / 10, 1 - (2 * ratio - 1) ** 3)
        damping, growth = max(damping, 1e-12), 2.0
        p, x0, cost = trial_p, trial_x, trial
        history.append(cost)
        watch(iteration, cost)
        if len(history) > SLOW_STEPS and history[-SLOW_STEPS - 1] - cost < SLOW_GAIN * cost:
            return Solution(p, x0, cost, "converged (slowly: rough cost)", True, iteration, tuple(history))
    return Solution(p, x0, cost, f"stopped after {max_iterations} iterations", False, max_iterations, tuple(history))


def _promises_little(normal: Normal, held: NDArray[np.bool_], cost: float, tolerance: float) -> bool:
    """Whether even the undamped step would hardly lower the cost."""
    promised = normal.predicted(*normal.step(1e-10, held))
    return promised <= tolerance * max(cost, np.finfo(float).tiny)


def _linearise(problem: Problem, scaling: _Scaling, p: Array, x0: Array) -> Normal:
    shot = problem.shooter(x0, p, sensitivities=True)
    r = problem.residuals(shot)
    used = problem.windows.used[..., None, None]
    weight = np.where(used, 1 / problem.scale[:, None], 0.0)
    by_p = shot.by_parameter * weight * scaling.p
    by_x = shot.by_state * weight * scaling.x
    if not problem.estimate_x0:
        by_x = np.zeros_like(by_x)
    w, rows = len(x0), r[0].size
    jp, jx = by_p.reshape(w, rows, -1) if by_p.size else np.zeros((w, rows, 0)), by_x.reshape(w, rows, -1)
    error = r.reshape(w, rows)
    flat = jp.reshape(w * rows, jp.shape[-1])
    return Normal(
        pp=flat.T @ flat,
        xx=jx.swapaxes(1, 2) @ jx,
        xp=jx.swapaxes(1, 2) @ jp,
        gp=-flat.T @ error.ravel(),
        gx=-np.einsum("wkm,wk->wm", jx, error),
    )


@dataclass(frozen=True)
class _Scaling:
    """Steps in multiples of each quantity's scale, inside the bounds."""

    positions: list[int]
    p: Array
    x: Array
    lower: Array
    upper: Array
    x_lower: Array
    x_upper: Array

    @classmethod
    def of(cls, problem: Problem) -> _Scaling:
        chosen = [problem.model.parameters[k] for k in problem.positions]
        states = problem.model.states
        return cls(
            positions=problem.positions,
            p=np.array([q.scale for q in chosen]),
            x=np.array([s.scale for s in states]),
            lower=np.array([q.lower for q in chosen]),
            upper=np.array([q.upper for q in chosen]),
            x_lower=np.array([s.lower for s in states]),
            x_upper=np.array([s.upper for s in states]),
        )

    def inside(self, p: Array) -> Array:
        q = np.array(p)
        q[self.positions] = np.clip(q[self.positions], self.lower, self.upper)
        return q

    def held(self, p: Array, gradient: Array) -> NDArray[np.bool_]:
        """Parameters at a bound that the gradient pushes outwards."""
        now = p[self.positions]
        return ((now <= self.lower) & (gradient > 0)) | ((now >= self.upper) & (gradient < 0))

    def move(self, p: Array, x0: Array, dp: Array, dx: Array) -> tuple[Array, Array]:
        q = np.array(p)
        q[self.positions] += dp * self.p
        return self.inside(q), np.clip(x0 + dx * self.x, self.x_lower, self.x_upper)

    def between(self, p: Array, x0: Array, q: Array, x1: Array) -> tuple[Array, Array]:
        """The scaled step really taken after clipping at the bounds."""
        return (q - p)[self.positions] / self.p, (x1 - x0) / self.x
