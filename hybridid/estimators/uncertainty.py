"""Standard errors that allow for autocorrelated residuals and for a model that is not the truth.

With J (N, n) the residuals' Jacobian by the parameters, initial states projected out, and
Sigma the covariance of the noise, ``cov = H^-1 (J' Sigma J) H^-1``, ``H = J' J``. The middle
is found twice, and each parameter keeps the larger of its two standard errors:

- from noise as ``hybridid.estimators.noise`` finds it: stationary, good for a few horizons
  too. For white residuals this is the classical ``sigma^2 H^-1``.
- from the scores of the horizons, ``sum_w g_w g_w'`` with ``g_w = J_w' r_w``, where there are
  enough of them: it asks nothing of the residual inside a horizon, which in a model that
  lacks an effect is louder in some motions than in others.

To this comes what the smoothing of sign(v) may have moved: a machine that truly sticks does not
creep as tanh(v/epsilon) does. To first order the estimate has moved by
``delta = -H^-1 J' epsilon dy/depsilon``, which counts as one more standard error. Where the
records are very precise it is the larger part, and only a smaller epsilon makes it less.

Source: Ljung (1999), System Identification, sec. 9.3; Liang, Zeger (1986), Biometrika 73(1);
JCGM 100 (2008), Guide to the expression of uncertainty in measurement, sec. 4.3 (type B).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hybridid.estimators.absorbed import Absorbed
from hybridid.estimators.carried import by_parameter
from hybridid.estimators.noise import autoregression
from hybridid.estimators.noise_driven import of_noise
from hybridid.estimators.normal_equations import small
from hybridid.estimators.problem import Problem
from hybridid.estimators.wild import wild
from hybridid.simulation.shooter import Shot
from hybridid.simulation.windows import PART, in_parts

__all__ = ["Uncertainty", "autoregression", "jacobian_of", "orthogonal", "uncertainty"]

Array = NDArray[np.float64]
BLIND = 1e-3
"""Share of a null direction of the Jacobian above which a parameter counts as not shown."""
SINGULAR = 1e-11
"""Ratio of singular values below which a direction counts as null: the simulation's rounding."""
ENOUGH = 20
"""Horizons from which on their scores say something of their spread."""
NUDGE = 0.05
"""Relative change of epsilon for the derivative by it."""


@dataclass(frozen=True)
class Uncertainty:
    """``covariance`` (n, n) of the free parameters, infinite on the diagonal where the data
    say nothing; ``condition`` number of the problem with each column scaled to one; ``smoothing``
    (n,) what the smoothing of sign(v) has moved them by, to first order, as the covariance has it. The error
    that it leaves in each output, as RMS in the output's unit, is ``smeared`` (n_y,)."""

    covariance: Array
    condition: float
    smoothing: Array
    smeared: Array

    @property
    def std(self) -> Array:
        """Standard errors of the free parameters, (n,), each in its parameter's unit."""
        return np.sqrt(np.maximum(np.diag(self.covariance), 0.0))

    @property
    def correlation(self) -> Array:
        """Correlation of the estimates, (n, n); an entry that is not finite becomes that of the identity."""
        s = self.std
        with np.errstate(divide="ignore", invalid="ignore"):
            ratio = self.covariance / np.outer(s, s)
        return np.where(np.isfinite(ratio), ratio, np.eye(len(s)))


def uncertainty(
    problem: Problem, p: Array, x0: Array, residual: Array | None = None, shot: Shot | None = None
) -> Uncertainty:
    """Covariance of the free parameters at a solution ``p`` (n_p,), ``x0`` (w, n_x).

    ``shot`` is the simulation there with sensitivities, if it is at hand. ``residual`` (w, H, n_y) takes the
    place of that of ``problem``, where another loss made the fit (``robust``).
    A parameter at a bound counts as free: its interval then says what the data say. Initial states
    that are not estimated count as exact.
    """
    shot = shot or problem.shooter(x0, p, sensitivities=True)
    scale = np.array([problem.model.parameters[k].scale for k in problem.positions])
    states, jacobian = _projected(problem, shot)
    shape = jacobian.shape
    jacobian *= scale
    if not small(states, jacobian):
        return _none(len(scale), len(problem.scale))
    q, spread, condition = orthogonal(jacobian.reshape(-1, len(scale)))
    residual = problem.residuals(shot) if residual is None else residual
    windows = problem.windows
    fitted = Absorbed(residual, windows.used, windows.cells, states, q.reshape(shape))
    with np.errstate(invalid="ignore"):
        noise, scores = (
            spread @ middle @ spread.T * np.outer(scale, scale)
            for middle in (of_noise(fitted, windows.origin), _of_scores(fitted))
        )
        more = np.sqrt(np.maximum(np.diag(scores) / np.diag(noise), 1.0))
        by_width = _by_width(problem, p, x0)
        along = np.einsum("whkn,whk->n", fitted.parameters, by_width)
        moved = -(spread @ along) * scale
    more[~np.isfinite(more)] = 1.0
    moved[~np.isfinite(moved)] = 0.0
    covariance = noise * np.outer(more, more) + np.outer(moved, moved)
    smeared = _smeared(by_width, fitted, along) * problem.scale
    return Uncertainty(_unknowable(spread, covariance), condition, moved, smeared)


def jacobian_of(problem: Problem, p: Array, x0: Array) -> Array | None:
    """The weighted Jacobian (N, n) by the free parameters at ``p`` (n_p,), ``x0`` (w, n_x), initial states
    projected out; None where the sensitivities grow without end."""
    states, jacobian = _projected(problem, problem.shooter(x0, p, sensitivities=True))
    return jacobian.reshape(-1, jacobian.shape[3]) if small(states, jacobian) else None


def _none(n: int, n_y: int) -> Uncertainty:
    """Of ``n`` parameters where the sensitivities grow without end: no error can be stated."""
    return Uncertainty(np.diag(np.full(n, np.inf)), np.inf, np.zeros(n), np.zeros(n_y))


def _by_width(problem: Problem, p: Array, x0: Array) -> Array:
    """``epsilon dy/depsilon`` (w, H, n_y) of the weighted outputs, every smoothing width changed by the same
    share."""
    if not problem.widths:
        return np.zeros((*problem.windows.used.shape, len(problem.scale)))
    step = np.zeros(len(p))
    step[problem.widths] = NUDGE * p[problem.widths]
    wider, sharper = (problem.residuals(problem.shooter(x0, q)) for q in (p + step, p - step))
    return (sharper - wider) / (2 * NUDGE)


def _smeared(by_width: Array, fitted: Absorbed, along: Array) -> Array:
    """RMS (n_y,) of what the smoothing leaves of the outputs that neither initial states nor parameters take:
    to first order, the difference to outputs without smoothing."""
    by_states = np.einsum("whkm,whk->wm", fitted.states, by_width)
    left = by_width - np.einsum("whkm,wm->whk", fitted.states, by_states)
    left -= np.einsum("whkn,n->whk", fitted.parameters, along)
    left = np.where(fitted.cells, left, 0.0)
    rms = np.sqrt((left**2).sum(axis=(0, 1)) / fitted.samples)
    return np.where(np.isfinite(rms), rms, 0.0)


def _projected(problem: Problem, shot: Shot) -> tuple[Array, Array]:
    """The weighted Jacobians of the residual, padding left out.

    By the initial states an orthonormal basis within each horizon, (w, H, n_y, n_x), none
    where they are known; by the parameters (w, H, n_y, n) with that basis projected out.
    """
    used = problem.windows.cells[..., None]
    by, per_scale = by_parameter(problem, shot), 1.0 / problem.scale[:, None]
    scale = np.array([problem.model.parameters[k].scale for k in problem.positions])
    jp: Array = np.empty(by.shape)
    sizes = np.empty(len(by))
    for part in in_parts(*by.shape[:2]):
        jp[part] = np.where(used[part], by[part] * per_scale, 0.0)
        sizes[part] = (np.abs(jp[part]).max(axis=(1, 2)) * scale).max(axis=1, initial=0.0)
    if (lost := wild(sizes)).any():
        jp[lost], used = 0.0, used & ~lost[:, None, None, None]
    if not problem.moving.any():
        return np.empty((*jp.shape[:3], 0)), jp
    jx = np.where(used, shot.by_state / problem.scale[:, None], 0.0)
    jx = np.where(problem.moving[:, None, None, :], jx, 0.0)
    w, length, n_y, n = jp.shape
    tall_x, tall_p = jx.reshape(w, length * n_y, -1), jp.reshape(w, length * n_y, n)
    with np.errstate(
        over="ignore", invalid="ignore"
    ):  # sensitivities that grow without end: no error is stated
        norms = np.linalg.norm(tall_x, axis=1, keepdims=True)
        basis, _ = np.linalg.qr(tall_x / np.where(norms > 0, norms, 1.0))
        # a state that no sample shows takes nothing from the residual
        basis = np.where(norms > 0, basis, 0.0)
        rest = tall_p - basis @ (basis.swapaxes(1, 2) @ tall_p)
    return basis.reshape(jx.shape), rest.reshape(jp.shape)


def orthogonal(jacobian: Array) -> tuple[Array, Array, float]:
    """``J = Q R``: Q (N, n), R^-1 (n, n) and the condition number of the column-scaled R.

    Working with R rather than J'J keeps the standard errors of nearly collinear
    parameters, whose J'J is singular to machine precision.
    """
    norms = np.linalg.norm(jacobian, axis=0)
    d = np.where(norms > 0, norms, 1.0)
    q, r = _by_parts(jacobian, d)
    u, s, vt = np.linalg.svd(r)
    floor = SINGULAR * s.max(initial=1.0)
    condition = float(s[0] / max(s[-1], np.finfo(float).tiny)) if len(s) else 1.0
    inverse = (vt.T / np.maximum(s, floor)) @ u.T
    blind = (np.abs(vt[s <= floor]) > BLIND).any(axis=0)
    inverse[blind] = np.inf
    return q, inverse / d[:, None], condition


def _by_parts(jacobian: Array, d: Array) -> tuple[Array, Array]:
    """QR decomposition of ``jacobian / d``, part by part, then of the parts' triangles below each other.
    Source: Demmel, Grigori, Hoemmen, Langou (2012), SIAM J. Sci. Comput. 34(1), A206-A239."""
    if len(jacobian) <= PART:
        return np.linalg.qr(jacobian / d)
    q = np.empty_like(jacobian)
    parts = in_parts(len(jacobian), 1)
    triangles = []
    for part in parts:
        q[part], triangle = np.linalg.qr(jacobian[part] / d)
        triangles.append(triangle)
    turns, r = np.linalg.qr(np.concatenate(triangles))
    for part, turn in zip(parts, np.split(turns, len(parts)), strict=True):
        q[part] = q[part] @ turn
    return q, r


def _unknowable(spread: Array, covariance: Array) -> Array:
    """Infinite variance, no covariance, for the parameters that no sample shows."""
    blind = ~np.isfinite(spread).all(axis=1)
    covariance = 0.5 * (covariance + covariance.T)
    covariance[blind, :] = covariance[:, blind] = 0.0
    covariance[blind, blind] = np.inf
    return covariance


def _of_scores(fitted: Absorbed) -> Array:
    """``sum_w g_w g_w'`` (n, n), zero where the horizons are too few."""
    count, n = len(fitted.used), fitted.parameters.shape[3]
    if count < max(ENOUGH, 2 * n):
        return np.zeros((n, n))
    scores = np.einsum("whkn,whk->wn", fitted.parameters, fitted.residual)
    return scores.T @ scores * count / (count - n)
