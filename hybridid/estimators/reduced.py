"""The reduced transcription: the decision variables are parameters and initial states, nothing else.

Each horizon is simulated from its initial state x_k, so that the states within it are eliminated and

    min over p, x_1 .. x_w of 1/2 sum_k |r_k(p, x_k)|^2,    r = (y - y_hat) / s,    inside bounds

has no constraints left. Its Jacobian comes from the sensitivities of the simulation. A Gauss-Newton step
eliminates the initial states horizon by horizon (``normal_equations``); where horizons hand inner states on,
all are solved together (``coupled``). Source: Bock (1987), Randwertproblemmethoden zur
Parameteridentifizierung; Golub, Pereyra (1973), SIAM J. Numer. Anal. 10(2), 413-432.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hybridid.estimators.carried import by_parameter
from hybridid.estimators.coupled import Coupled
from hybridid.estimators.jacobian import columns, products
from hybridid.estimators.multiple_shooting import MultipleShooting, Program
from hybridid.estimators.normal_equations import Normal
from hybridid.estimators.problem import Problem
from hybridid.estimators.wild import wild
from hybridid.simulation.shooter import Shot

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Reduced:
    """Transcribes a problem into parameters and the initial state of each horizon."""

    def least_squares(self, problem: Problem) -> LeastSquares:
        """The problem in scaled variables, for a solver of least squares."""
        return LeastSquares.of(problem)

    def program(self, problem: Problem, p: Array, x0: Array) -> Program:
        """The problem as a nonlinear program: each horizon one interval, which leaves no gap to close."""
        return MultipleShooting(problem.windows.length).program(problem, p, x0)


@dataclass(frozen=True)
class LeastSquares:
    """Free parameters and initial states in multiples of their scales ``p`` (n,) and ``x`` (n_x,), inside
    their bounds."""

    problem: Problem
    positions: list[int]
    p: Array
    x: Array
    lower: Array
    upper: Array
    x_lower: Array
    x_upper: Array

    @classmethod
    def of(cls, problem: Problem) -> LeastSquares:
        """The variables of ``problem``."""
        chosen = [problem.model.parameters[k] for k in problem.positions]
        states = problem.model.states
        return cls(
            problem=problem,
            positions=problem.positions,
            p=np.array([q.scale for q in chosen]),
            x=np.array([s.scale for s in states]),
            lower=np.array([q.lower for q in chosen]),
            upper=np.array([q.upper for q in chosen]),
            x_lower=np.array([s.lower for s in states]),
            x_upper=np.array([s.upper for s in states]),
        )

    def linearised(self, shot: Shot) -> Normal | Coupled:
        """The normal equations at a shot with sensitivities."""
        problem = self.problem
        if problem.couples:
            with np.errstate(over="ignore", invalid="ignore"):
                return Coupled.of(problem, shot, self.p, self.x)
        square, error = self._tamed(*_products(problem, shot))
        m, moving = len(self.x), problem.moving
        with np.errstate(over="ignore", invalid="ignore"):
            xx = square[:, :m, :m] * np.outer(self.x, self.x)
            xp = square[:, :m, m:] * np.outer(self.x, self.p)
            return Normal(
                pp=square[:, m:, m:].sum(axis=0) * np.outer(self.p, self.p),
                xx=np.where(moving[:, :, None] & moving[:, None, :], xx, 0.0),
                xp=np.where(moving[:, :, None], xp, 0.0),
                gp=-error[:, m:].sum(axis=0) * self.p,
                gx=-np.where(moving, error[:, :m], 0.0) * self.x,
            )

    def _tamed(self, square: Array, error: Array) -> tuple[Array, Array]:
        """J'J (w, q, q) and J'r (w, q), zero where a horizon's sensitivities are wild."""
        diagonal = np.einsum("wqq->wq", square)
        sizes = np.sqrt(np.maximum(diagonal, 0.0)) * np.concatenate([self.x, self.p])
        tame = ~wild(sizes.max(axis=1, initial=0.0))
        return (square, error) if tame.all() else (square * tame[:, None, None], error * tame[:, None])

    def inside(self, p: Array, x0: Array) -> tuple[Array, Array]:
        """``p`` (n_p,) and ``x0`` (w, n_x) clipped at the bounds."""
        q = np.array(p)
        q[self.positions] = np.clip(q[self.positions], self.lower, self.upper)
        return q, np.clip(x0, self.x_lower, self.x_upper)

    def held(self, p: Array, gradient: Array) -> NDArray[np.bool_]:
        """Parameters (n,) at a bound that the gradient pushes outwards."""
        return _pushed(p[self.positions], gradient, self.lower, self.upper)

    def held_states(self, x0: Array, gradient: Array) -> NDArray[np.bool_]:
        """Initial states (w, n_x) at a bound that the gradient pushes outwards."""
        return _pushed(x0, gradient, self.x_lower, self.x_upper)

    def moved(self, p: Array, x0: Array, dp: Array, dx: Array) -> tuple[Array, Array]:
        """Parameters and initial states after a scaled step, clipped at the bounds."""
        q = np.array(p)
        q[self.positions] += dp * self.p
        return self.inside(q, x0 + dx * self.x)

    def between(self, p: Array, x0: Array, q: Array, x1: Array) -> tuple[Array, Array]:
        """The scaled step really taken after clipping at the bounds."""
        return (q - p)[self.positions] / self.p, (x1 - x0) / self.x


def _products(problem: Problem, shot: Shot) -> tuple[Array, Array]:
    """J'J (w, q, q) and J'r (w, q) of each horizon."""
    if shot.multiplied:
        return shot.square, shot.error
    return products(problem, shot, columns(problem, shot.by_state, by_parameter(problem, shot)))


def _pushed(now: Array, gradient: Array, lower: Array, upper: Array) -> NDArray[np.bool_]:
    return ((now <= lower) & (gradient > 0)) | ((now >= upper) & (gradient < 0))


def promise(problem: Problem, p: Array, x0: Array) -> float:
    """Predicted decrease of the cost by a full Gauss-Newton step from ``p``, ``x0``, as in a score test.
    It ranks starts. 0 where the sensitivities diverge."""
    variables = LeastSquares.of(problem)
    normal = variables.linearised(problem.shot(x0, p, sensitivities=True))
    if not normal.finite:
        return 0.0
    held = variables.held(p, normal.gp)
    return normal.predicted(*normal.step(1e-8, held))
