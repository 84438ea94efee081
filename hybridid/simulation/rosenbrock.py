"""RODAS3: a linearly implicit method for stiff models, with exact Jacobians.

With ``W = I / (γ h) - df/dx`` a step solves four linear systems with one matrix,

    W k_i = f(t + α_i h, x + Σ_j a_ij k_j, u) + Σ_j c_ij k_j / h + γ_i h df/dt,   x⁺ = x + Σ m_i k_i,

It is of third order and L-stable: a stiff mode (a bristle of a friction model, a motor's small inertia
behind a spring) is damped for any step. There is no iteration: the step is an explicit formula, which
shooting can differentiate.

Its stages are at the two ends of the step, where the inputs are known. ``df/dt`` includes the slope of
the inputs at the start of the step, from the parabola through start, middle and end. The error of this
slope contributes h⁴ to a step and keeps the order.

Source: Sandu, Verwer, Blom, Spee, Carmichael, Potra (1997), "Benchmarking stiff ODE solvers for
atmospheric chemistry problems II: Rosenbrock solvers", Atmospheric Environment 31(20), 3459-3472,
in the form of Hairer, Wanner (1996), Solving Ordinary Differential Equations II, sec. IV.7.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import casadi as ca

from hybridid.model import Model
from hybridid.simulation.elimination import Elimination

GAMMA = 0.5
A = ((), (0.0,), (2.0, 0.0), (2.0, 0.0, 1.0))
C = ((), (4.0,), (1.0, -1.0), (1.0, -1.0, -8 / 3))
M = (2.0, 0.0, 1.0, 1.0)
AT_END = (False, False, True, True)
"""Whether a stage is at the end of the step (α = 1) or at its start (α = 0)."""
SLOPE = (0.5, 1.5, 0.0, 0.0)
"""γ_i, the weight of h df/dt."""


@dataclass(frozen=True)
class Inputs:
    """Inputs (n_u,) at the start, the middle and the end of a step."""

    first: ca.SX
    middle: ca.SX
    last: ca.SX

    @classmethod
    def of(cls, u: ca.SX, held: bool) -> Inputs:
        """From ``U`` of a step: (n_u,) if held, else (3 n_u,)."""
        return cls(u, u, u) if held else cls(*ca.vertsplit(u, u.shape[0] // 3))

    def at(self, share: float) -> ca.SX:
        """The inputs at 0, 0.5 or 1 of the step."""
        return {0.0: self.first, 0.5: self.middle, 1.0: self.last}[share]

    def slope(self, h: float | ca.SX) -> ca.SX:
        """du/dt at the start of the step, exact for a parabola."""
        if self.first is self.last:
            return ca.SX.zeros(self.first.shape)
        return (-3 * self.first + 4 * self.middle - self.last) / h


@dataclass(frozen=True)
class Rodas3:
    """The method for one model."""

    model: Model

    def step(self, t: ca.SX, h: float | ca.SX, x: ca.SX, u: Inputs, p: ca.SX) -> ca.SX:
        """The state at ``t + h`` from ``x`` at ``t``."""
        return x + weighted(M, self.stages(t, h, x, u, p)[0])

    def stages(
        self, t: ca.SX, h: float | ca.SX, x: ca.SX, u: Inputs, p: ca.SX
    ) -> tuple[list[ca.SX], Elimination]:
        """The k_i of a step, and the elimination of its W."""
        rate, jacobian, drift = self._linearised(t, x, u.first, p, u.slope(h))
        system = Elimination.of(ca.SX.eye(x.shape[0]) / (GAMMA * h) - jacobian)
        k: list[ca.SX] = []
        for i, at_end in enumerate(AT_END):
            if at_end:
                rate = self.model.f(t + h, x + weighted(A[i], k), u.last, p)
            k.append(system.solve(rate + weighted(C[i], k) / h + SLOPE[i] * h * drift))
        return k, system

    @cached_property
    def _linearised(self) -> ca.Function:
        """``(t, x, u, p, du/dt) -> f, df/dx, df/dt`` with the inputs' slope in df/dt."""
        n_u = len(self.model.inputs)
        t, x, u = ca.SX.sym("t"), ca.SX.sym("x", len(self.model.states)), ca.SX.sym("u", n_u)
        p, slope = ca.SX.sym("p", len(self.model.parameters)), ca.SX.sym("du", n_u)
        rate = self.model.f(t, x, u, p)
        drift = ca.jtimes(rate, ca.vertcat(t, u), ca.vertcat(1, slope))
        return ca.Function("linearised", [t, x, u, p, slope], [rate, ca.jacobian(rate, x), drift])


def weighted(weights: Sequence[float], terms: Sequence[ca.SX]) -> ca.SX:
    """The sum of the ``terms``, each times its weight; 0 if there are none."""
    total = ca.SX.zeros(terms[0].shape) if terms else ca.SX(0)
    for weight, term in zip(weights, terms, strict=True):
        if weight:
            total = total + weight * term
    return total
