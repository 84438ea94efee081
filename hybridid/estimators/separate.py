"""Initial states at known parameters: each horizon is a least-squares problem of its own.

Where no parameter is free and no inner state passes from horizon to horizon,

    min over x_1 .. x_w of 1/2 sum_k |r_k(x_k)|^2

falls apart into w problems of n_x unknowns. Each has a damping of its own, so that one horizon whose cost is
rough (stick and slip) does not hold up the others. Those that have converged are simulated no more. The steps
and the rule for the damping are those of ``levenberg_marquardt``.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hybridid.estimators.carried import carries_nothing
from hybridid.estimators.estimate import Solution
from hybridid.estimators.normal_equations import STATE_RIDGE, damped, small
from hybridid.estimators.problem import Problem
from hybridid.estimators.reduced import LeastSquares
from hybridid.estimators.stop import SLOW_GAIN, SLOW_SHARE, SLOW_STEPS, Stop

Array = NDArray[np.float64]
Marks = NDArray[np.bool_]
FIRST, LEAST, MOST = 1e-4, 1e-12, 1e12
"""Dampings: of the first step, and the bounds of the others."""
FULL = 1e-10
"""Damping of a full Gauss-Newton step."""
TRIALS = 2
"""Simulations for each iteration that is allowed: a step that does not lower the cost takes one, too."""


@dataclass(frozen=True)
class _Point:
    """Horizons at initial states ``x`` (w, n_x): ``cost`` (w,) of each, and its scaled normal equations,
    ``gradient`` (w, n_x) and ``matrix`` (w, n_x, n_x)."""

    x: Array
    cost: Array
    gradient: Array
    matrix: Array

    def step(self, damping: Array) -> Array:
        """The damped steps (w, n_x) for dampings (w,)."""
        matrix = damped(self.matrix, damping[:, None], STATE_RIDGE)
        return np.asarray(np.linalg.solve(matrix, -self.gradient[..., None])[..., 0], dtype=float)

    def promised(self, step: Array) -> Array:
        """Decrease of each cost (w,) that the linear model promises for a step (w, n_x)."""
        square = np.einsum("wm,wml,wl->w", step, self.matrix, step)
        return np.asarray(-np.einsum("wm,wm->w", self.gradient, step) - 0.5 * square)

    def taking(self, rows: NDArray[np.intp], other: _Point) -> _Point:
        """These horizons, with those in ``rows`` as they are in ``other``."""
        fields = {name: np.array(getattr(self, name)) for name in ("x", "cost", "gradient", "matrix")}
        for name, array in fields.items():
            array[rows] = getattr(other, name)
        return _Point(**fields)

    def only(self, rows: NDArray[np.intp]) -> _Point:
        """The horizons in ``rows``."""
        return _Point(self.x[rows], self.cost[rows], self.gradient[rows], self.matrix[rows])


def is_separate(problem: Problem) -> bool:
    """Whether the horizons of ``problem`` share nothing that is to be found."""
    return not problem.free and carries_nothing(problem)


def solve_separately(variables: LeastSquares, p: Array, x0: Array, stop: Stop) -> Solution:
    """Minimise the cost of each horizon from ``x0`` (w, n_x) at the parameters ``p`` (n_p,).

    It has converged when a full Gauss-Newton step of no horizon promises more than its share of
    ``stop.tolerance`` times the whole cost, when only rounding is left, or when the others' cost is rough.
    """
    problem = variables.problem
    p, x0 = variables.inside(p, x0)
    now = _at(problem, p, x0)
    w = problem.windows.count
    if not np.isfinite(now.cost).all():
        return Solution(p, x0, np.inf, "the simulation diverges at the start", False, 0)
    damping, growth, history = np.full(w, FIRST), np.full(w, 2.0), [now.cost]
    slow = min(SLOW_SHARE * stop.tolerance, SLOW_GAIN)
    for count in range(TRIALS * stop.iterations):
        whole = now.cost.sum()
        little = max(stop.tolerance * whole, problem.rounding) / w
        unfinished = now.promised(now.step(np.full(w, FULL))) > little
        if count >= SLOW_STEPS:
            unfinished &= history[-SLOW_STEPS - 1] - now.cost > slow * whole / w
        rows = np.flatnonzero(unfinished & (damping < MOST))
        if not len(rows):
            status = "stalled: no step lowers the cost" if unfinished.any() else "converged"
            return _solution(p, now, status, not unfinished.any(), count, history)
        here = now.only(rows)
        _, there = variables.moved(p, here.x, np.zeros(0), here.step(damping[rows]))
        promised = here.promised((there - here.x) / variables.x)
        tried = _at(problem if len(rows) == w else problem.on(rows.tolist()), p, there)
        with np.errstate(invalid="ignore", divide="ignore"):
            ratio = np.where(promised > 0, (here.cost - tried.cost) / promised, -1.0)
        better = np.isfinite(tried.cost) & (ratio > 0)
        eased = np.maximum(1 / 10, 1 - (2 * ratio - 1) ** 3)
        damping[rows] *= np.where(better, eased, growth[rows])
        damping = np.maximum(damping, LEAST)
        growth[rows] = np.where(better, 2.0, 2 * growth[rows])
        now = now.taking(rows[better], tried.only(np.flatnonzero(better)))
        history.append(now.cost)
    most = TRIALS * stop.iterations
    return _solution(p, now, f"stopped after {most} trials", False, most, history)


def _solution(
    p: Array, now: _Point, status: str, converged: bool, count: int, history: list[Array]
) -> Solution:
    costs = tuple(float(one.sum()) for one in history)
    return Solution(p, now.x, costs[-1], status, converged, count, costs)


def _at(problem: Problem, p: Array, x: Array) -> _Point:
    """The horizons of ``problem`` at ``x`` (w, n_x). Normal equations that leave the numbers are zero: such a
    horizon stays where it is."""
    variables = LeastSquares.of(problem)
    shot = problem.shot(x, p, sensitivities=True)
    normal = variables.linearised(shot)
    gradient, matrix = normal.gx, normal.xx  # type: ignore[union-attr]  # nothing is handed on
    held = variables.held_states(x, gradient)
    free = np.where(held, 0.0, 1.0) * np.array([[small(g, m)] for g, m in zip(gradient, matrix, strict=True)])
    with np.errstate(invalid="ignore"):
        gradient = np.where(free > 0, gradient, 0.0)
        matrix = np.where((free[:, :, None] > 0) & (free[:, None, :] > 0), matrix, 0.0)
    return _Point(x, problem.costs(shot), gradient, matrix)
