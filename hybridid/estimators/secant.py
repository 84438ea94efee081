"""The second derivatives that Gauss-Newton leaves out, learned from the steps of a descent.

The Hessian of the cost ``1/2 |r(p)|^2`` is ``J'J + S``, S the sum of each residual times its own Hessian.
Where a model leaves a large error, S is large too: Gauss-Newton steps, which leave it out, go too far, and
the descent swings about the optimum. A step d from p to p+ changes the gradient g by about the Hessian times
d, and so shows how S acts along d:

    S d = g+ - g - J+'J+ d.

A symmetric estimate of S takes this up after each step by the update of Dennis, Gay and Welsch, made smaller
beforehand where it was too large. The next step uses it where Gauss-Newton alone told the last decrease of
the cost poorly, and did so no better than with S. Where Gauss-Newton tells it well, it converges fast.

The estimate is of the parameters alone. Where initial states are estimated too, it would leave out how they
follow: then there is none. Source: Dennis, Gay, Welsch (1981), An adaptive nonlinear least-squares algorithm,
ACM Transactions on Mathematical Software 7(3), 348-368, sec. 3; Nocedal, Wright (2006), Numerical
Optimization, sec. 10.4.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import LinAlgError, eigh

from hybridid.estimators.coupled import Coupled
from hybridid.estimators.normal_equations import RIDGE, Normal, damped
from hybridid.estimators.reduced import LeastSquares

Array = NDArray[np.float64]
CONVEX = -0.5
"""Least eigenvalue of S against J'J: the model of the cost keeps half of its curvature in each direction."""
POOR = 0.25
"""Share of the promised decrease by which Gauss-Newton may miss the true one. It misses about this share
where each step leaves this share of the distance to the optimum."""
RIDGES = 1e8 * RIDGE
"""Added to the diagonal of J'J, as a share of it: a direction that no sample shows has an eigenvalue too."""


@dataclass(frozen=True)
class Place:
    """A point of the descent: scaled parameters (n,), cost, gradient (n,) and J'J (n, n)."""

    at: Array
    cost: float
    gradient: Array
    square: Array


@dataclass(frozen=True)
class Secant:
    """The estimate S (n, n), the ``last`` place, and whether the next step ``uses`` S."""

    matrix: Array
    last: Place | None = None
    uses: bool = False

    @classmethod
    def of(cls, variables: LeastSquares) -> Secant | None:
        """Nothing learned yet; None where initial states are estimated."""
        if variables.problem.moving.any():
            return None
        return cls(np.zeros((len(variables.p), len(variables.p))))

    def at(self, place: Array, cost: float, normal: Normal | Coupled) -> Secant:
        """What the step to ``place`` (n,), with this cost and these normal equations, shows in addition."""
        if isinstance(normal, Coupled):
            return self
        now = Place(place, cost, normal.gp, normal.pp)
        if self.last is None:
            return replace(self, last=now)
        return Secant(self._updated(self.last, now), now, self._told(self.last, now))

    def _told(self, before: Place, now: Place) -> bool:
        """Whether Gauss-Newton alone told the decrease of the cost poorly, and no better than with S."""
        step = now.at - before.at
        promised = -before.gradient @ step - 0.5 * step @ before.square @ step
        missed = before.cost - now.cost - promised
        with_estimate = missed + 0.5 * step @ self.matrix @ step
        return bool(abs(missed) > POOR * abs(promised) and abs(with_estimate) <= abs(missed))

    def added_to(self, normal: Normal | Coupled) -> Normal | Coupled:
        """The normal equations with S in them, as far as they stay convex."""
        if isinstance(normal, Coupled) or not (self.uses and self.matrix.any()):
            return normal
        metric = damped(normal.pp, RIDGES, RIDGE)
        try:
            share, along = eigh(self.matrix, metric)
        except LinAlgError:  # J'J is singular to rounding: then nothing bounds S
            return normal
        across = metric @ along
        return replace(normal, pp=normal.pp + (across * np.maximum(share, CONVEX)) @ across.T)

    def _updated(self, before: Place, now: Place) -> Array:
        step, gradients = now.at - before.at, now.gradient - before.gradient
        met = float(gradients @ step)
        if not (np.isfinite(now.square).all() and met > 0):
            return self.matrix
        shown, known = gradients - now.square @ step, self.matrix @ step
        own = float(step @ known)
        size = min(1.0, abs(float(step @ shown) / own)) if own else 1.0
        missing = shown - size * known
        both = np.outer(missing, gradients) / met
        twice = (step @ missing) / met**2 * np.outer(gradients, gradients)
        return size * self.matrix + both + both.T - twice
