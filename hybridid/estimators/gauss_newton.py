"""Levenberg-Marquardt on parameters and initial states together.

Source: Björck (1996), Numerical Methods for Least Squares Problems, sec. 9.2; damping by
Nielsen (1999), IMM-REP-1999-05.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from hybridid.estimators.carried import by_parameter, carry
from hybridid.estimators.coupled import Coupled, couples
from hybridid.estimators.estimate import Solution
from hybridid.estimators.normal_equations import Normal
from hybridid.estimators.problem import Problem
from hybridid.simulation.shooter import Shot

Array = NDArray[np.float64]
MOST_DAMPING = 1e12
LOOSE = 1e-4
"""Tolerance of the descents at coarser smoothing, which only lead to the next."""
SLOW_STEPS, SLOW_SHARE, SLOW_GAIN = 10, 1e3, 1e-3
"""Stick and slip make the cost of long horizons rough: descent then creeps from kink to kink. It
ends when ten steps gain less than a thousand times the tolerance, and less than a thousandth."""
ROUGH = "converged (slowly: rough cost)"
EXACT = 1e-10
"""Residual over the output's standard deviation that is the arithmetic's own."""


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
    full Gauss-Newton step promises a relative decrease of the cost below ``tolerance``, that
    nothing but rounding is left, or that the cost is rough: the last ``SLOW_STEPS`` steps together gained
    hardly more, or no step lowers it and none promised more.
    """
    scaling = _Scaling.of(problem)
    begun = 0
    factors = factors if problem.widths else factors[-1:]
    for k, factor in enumerate(factors):
        last = k == len(factors) - 1
        counted = _from(watch, begun)
        found = _descend(
            problem,
            scaling,
            problem.smoothed(p, factor),
            x0,
            max_iterations,
            tolerance if last else LOOSE,
            counted,
        )
        p, x0, begun = found.p, found.x0, begun + found.iterations
    return replace(found, x0=carry(problem, p, x0), iterations=begun)


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
    p, x0 = scaling.inside(p), np.clip(x0, scaling.x_lower, scaling.x_upper)
    shot = problem.shooter(x0, p, sensitivities=True)
    cost = problem.cost(shot)
    if not np.isfinite(cost):
        return Solution(p, x0, np.inf, "the simulation diverges at the start", False, 0)
    damping, growth, history = 1e-4, 2.0, [cost]
    rounding = 0.5 * EXACT**2 * problem.windows.samples * len(problem.scale)
    slow = min(SLOW_SHARE * tolerance, SLOW_GAIN)
    eager = True  # the last step was taken at its first trial: so may the next be, and then slopes are needed
    for iteration in range(1, max_iterations + 1):
        normal = _linearise(problem, scaling, shot if shot.sensitive else problem.shooter(x0, p, True))
        if not normal.finite:
            blown = "the sensitivities diverge: the integrator needs shorter steps"
            return Solution(p, x0, cost, blown, False, iteration, tuple(history))
        held = scaling.held(p, normal.gp)
        normal = normal.holding(scaling.held_states(x0, normal.gx))
        if cost <= rounding or _promises_little(normal, held, cost, tolerance):
            return Solution(p, x0, cost, "converged", True, iteration - 1, tuple(history))
        while True:
            dp, dx = normal.step(damping, held)
            trial_p, trial_x = scaling.move(p, x0, dp, dx)
            promised = normal.predicted(*scaling.between(p, x0, trial_p, trial_x))
            shot = problem.shooter(trial_x, trial_p, sensitivities=eager and iteration < max_iterations)
            trial = problem.cost(shot)
            ratio = (cost - trial) / promised if promised > 0 else -1.0
            if np.isfinite(trial) and ratio > 0:
                break
            damping, growth, eager = damping * growth, growth * 2, False
            if damping > MOST_DAMPING:
                there = _promises_little(normal, held, cost, slow)
                status = ROUGH if there else "stalled: no step lowers the cost"
                return Solution(p, x0, cost, status, there, iteration, tuple(history))
        damping *= max(1 / 10, 1 - (2 * ratio - 1) ** 3)
        damping, growth, eager = max(damping, 1e-12), 2.0, growth == 2.0
        p, x0, cost = trial_p, trial_x, trial
        history.append(cost)
        watch(iteration, cost)
        if len(history) > SLOW_STEPS and history[-SLOW_STEPS - 1] - cost < slow * cost:
            return Solution(p, x0, cost, ROUGH, True, iteration, tuple(history))
    return Solution(
        p, x0, cost, f"stopped after {max_iterations} iterations", False, max_iterations, tuple(history)
    )


def promise(problem: Problem, p: Array, x0: Array) -> float:
    """Decrease of the cost that a full Gauss-Newton step from ``p``, ``x0`` promises: a score test's answer,
    good for telling which of many starts is worth a descent. 0 where the sensitivities diverge."""
    scaling = _Scaling.of(problem)
    normal = _linearise(problem, scaling, problem.shooter(x0, p, sensitivities=True))
    if not normal.finite:
        return 0.0
    held = scaling.held(p, normal.gp)
    return normal.predicted(*normal.step(1e-8, held))


def _promises_little(
    normal: Normal | Coupled, held: NDArray[np.bool_], cost: float, tolerance: float
) -> bool:
    """Whether even the undamped step would hardly lower the cost."""
    promised = normal.predicted(*normal.step(1e-10, held))
    return promised <= tolerance * max(cost, np.finfo(float).tiny)


def _linearise(problem: Problem, scaling: _Scaling, shot: Shot) -> Normal | Coupled:
    if couples(problem):
        with np.errstate(over="ignore", invalid="ignore"):
            return Coupled.of(problem, shot, scaling.p, scaling.x)
    r = problem.residuals(shot)
    # what lies beyond a record's end may have left the range of numbers
    used = problem.windows.used[..., None, None]
    with np.errstate(over="ignore"):
        by_p = np.where(used, by_parameter(problem, shot) / problem.scale[:, None], 0.0) * scaling.p
        by_x = np.where(used, shot.by_state / problem.scale[:, None], 0.0) * scaling.x
    by_x = np.where(problem.moving[:, None, None, :], by_x, 0.0)
    w, rows = len(r), r[0].size
    jp, jx = by_p.reshape(w, rows, -1) if by_p.size else np.zeros((w, rows, 0)), by_x.reshape(w, rows, -1)
    error = r.reshape(w, rows)
    flat = jp.reshape(w * rows, jp.shape[-1])
    with np.errstate(over="ignore", invalid="ignore"):
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

    def held_states(self, x0: Array, gradient: Array) -> NDArray[np.bool_]:
        """Initial states (w, m) at a bound that the gradient pushes outwards."""
        return ((x0 <= self.x_lower) & (gradient > 0)) | ((x0 >= self.x_upper) & (gradient < 0))

    def move(self, p: Array, x0: Array, dp: Array, dx: Array) -> tuple[Array, Array]:
        q = np.array(p)
        q[self.positions] += dp * self.p
        return self.inside(q), np.clip(x0 + dx * self.x, self.x_lower, self.x_upper)

    def between(self, p: Array, x0: Array, q: Array, x1: Array) -> tuple[Array, Array]:
        """The scaled step really taken after clipping at the bounds."""
        return (q - p)[self.positions] / self.p, (x1 - x0) / self.x
