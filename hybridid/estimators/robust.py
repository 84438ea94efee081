"""Huber's loss, by reweighted least squares: outliers count linearly.

    rho(r) = r²/2 for |r| <= k,  k |r| - k²/2 beyond,    k = 1.345 sigma,  sigma = median |r| / 0.6745

of each output's residual r. A fit of least squares with the weights ``min(1, k/|r|)`` has the gradient of
this cost. So fit, weights and sigma follow from each other until they stay. With 1.345, an estimate under
Gaussian noise is 95 % as efficient as that of least squares.

Its covariance is the sandwich ``A^-1 B A^-1`` with ``A = m J'J`` and ``B = J' Cov(psi) J``: psi is the
residual clipped at k, and m the share of the samples that are not clipped. That is the covariance of least
squares for the residual ``psi/m``, which ``uncertainty`` finds for noise that is autocorrelated, too.

Source: Huber (1981), Robust Statistics, ch. 7; Holland, Welsch (1977), Communications in Statistics A6(9).
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from hybridid.estimators.estimate import Solution
from hybridid.estimators.one_start import carried_to_the_end
from hybridid.estimators.plan import Descent, Result, Start
from hybridid.estimators.problem import Problem
from hybridid.estimators.stop import Watch

Array = NDArray[np.float64]
THRESHOLD = 1.345
"""Standard deviations beyond which a residual counts linearly."""
NORMAL = 0.6745
"""Median of |r| of Gaussian noise, in its standard deviations."""
ROUNDS = 50
SETTLED = 1e-3
"""Largest change of a weight from one round to the next at which they stay."""
EXACT = 1e-10
"""Standard deviation, over that of the output, that is the arithmetic's own: nothing is an outlier."""


@dataclass(frozen=True)
class Clipped:
    """Residuals (w, H, n_y) of a solution and where each output's are clipped, ``at`` (n_y,)."""

    residual: Array
    cells: NDArray[np.bool_]
    at: Array

    @classmethod
    def of(cls, problem: Problem, solution: Solution) -> Clipped:
        """Of ``problem``, whose weights do not count."""
        plain = replace(problem, weights=None)
        residual = plain.residuals(problem.shooter(solution.x0, solution.p))
        cells = problem.windows.cells
        size = np.where(cells, np.abs(residual), np.nan).reshape(-1, residual.shape[2])
        sigma = np.nanmedian(size, axis=0) / NORMAL
        return cls(residual, cells, THRESHOLD * np.where(sigma > EXACT, sigma, np.inf))

    @property
    def weights(self) -> Array:
        """Square roots of the weights of least squares, (w, H, n_y)."""
        size = np.maximum(np.abs(self.residual), np.finfo(float).tiny)
        return np.sqrt(np.minimum(1.0, self.at / size))

    @property
    def cost(self) -> float:
        """Huber's cost."""
        inside = np.minimum(np.abs(self.residual), self.at)
        beyond = np.abs(self.residual) - inside
        return float(np.sum(0.5 * inside**2 + np.where(beyond > 0, self.at, 0.0) * beyond))

    @property
    def pseudo(self) -> Array:
        """The residual (w, H, n_y) of which least squares have the covariance of this fit."""
        inside = self.cells & (np.abs(self.residual) <= self.at)
        kept = inside.sum(axis=(0, 1)) / self.cells.sum(axis=(0, 1))
        return np.clip(self.residual, -self.at, self.at) / kept


def reweighted(found: Result, plan: Descent, watch: Watch) -> Result:
    """Where reweighted least squares end that begin at ``found``, the squared loss' optimum. Its cost is
    Huber's."""
    problem, solution = found.problem, found.solution
    weights, settled = np.ones(0), False
    for _ in range(ROUNDS):
        before, weights = weights, Clipped.of(problem, solution).weights
        settled = before.shape == weights.shape and bool(np.abs(weights - before).max() < SETTLED)
        if settled:
            break
        start = Start(replace(problem, weights=weights), solution.p, solution.x0, watch=watch)
        again = carried_to_the_end(
            start, plan, plan.continuation[-1:], plan.refinement.handover, None
        ).solution
        solution = replace(again, iterations=solution.iterations + again.iterations)
    cost = Clipped.of(problem, solution).cost
    if not settled:
        status = f"the weights of the outliers do not settle in {ROUNDS} rounds"
        solution = replace(solution, converged=False, status=status)
    return replace(found, solution=replace(solution, cost=cost), x0=solution.x0)
