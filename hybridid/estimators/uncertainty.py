"""Standard errors that allow for autocorrelated residuals.

With J (N, n) the residuals' Jacobian by the parameters, initial states projected out, and
Sigma the covariance of the residuals, ``cov = H^-1 (J' Sigma J) H^-1``, ``H = J' J``. Each
output's residual is described by an autoregression, so that ``J' Sigma J`` is an integral
over frequency of its spectrum times J's cross-spectra. For white residuals this is the
classical ``sigma^2 H^-1``. Source: Ljung (1999), System Identification, sec. 9.3;
Hannan (1970), Multiple Time Series, ch. VII.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import solve_toeplitz

from hybridid.estimators.problem import Problem

Array = NDArray[np.float64]
BLIND = 1e-3
"""Share of a null direction of the Jacobian above which a parameter counts as not shown."""
MOST_LAGS = 50
"""Longest autoregression tried; its order minimises the Bayesian information criterion."""


@dataclass(frozen=True)
class Uncertainty:
    """``covariance`` (n, n) of the free parameters, infinite on the diagonal where the data
    say nothing; ``condition`` number of the problem with each column scaled to one."""

    covariance: Array
    condition: float

    @property
    def std(self) -> Array:
        return np.sqrt(np.maximum(np.diag(self.covariance), 0.0))

    @property
    def correlation(self) -> Array:
        s = self.std
        with np.errstate(divide="ignore", invalid="ignore"):
            ratio = self.covariance / np.outer(s, s)
        return np.where(np.isfinite(ratio), ratio, np.eye(len(s)))


def uncertainty(problem: Problem, p: Array, x0: Array) -> Uncertainty:
    """Covariance of the free parameters at a solution ``p`` (n_p,), ``x0`` (w, n_x).

    A parameter at a bound counts as free: its interval then says what the data say.
    """
    shot = problem.shooter(x0, p, sensitivities=True)
    scale = np.array([problem.model.parameters[k].scale for k in problem.positions])
    residuals = problem.residuals(shot)
    jacobian = _projected(problem, shot.by_parameter * scale, shot.by_state)
    n, n_y = len(scale), residuals.shape[2]
    q, spread, condition = _orthogonal(jacobian.reshape(-1, n))
    basis = q.reshape(jacobian.shape)
    states = x0.size if problem.estimate_x0 else 0
    rows = problem.windows.samples * n_y
    used = problem.windows.used
    middle = sum((_sandwich(basis[:, :, k], residuals[:, :, k], used) for k in range(n_y)), np.zeros((n, n)))
    middle *= rows / max(rows - n - states, 1)
    with np.errstate(invalid="ignore"):
        covariance = spread @ middle @ spread.T * np.outer(scale, scale)
    return Uncertainty(_unknowable(spread, covariance), condition)


def _orthogonal(jacobian: Array) -> tuple[Array, Array, float]:
    """``J = Q R``: Q (N, n), R^-1 (n, n) and the condition number of the column-scaled R.

    Working with R rather than J'J keeps the standard errors of nearly collinear
    parameters, whose J'J is singular to machine precision.
    """
    norms = np.linalg.norm(jacobian, axis=0)
    d = np.where(norms > 0, norms, 1.0)
    q, r = np.linalg.qr(jacobian / d)
    u, s, vt = np.linalg.svd(r)
    floor = np.finfo(float).eps * len(jacobian) ** 0.5
    condition = float(s[0] / max(s[-1], np.finfo(float).tiny)) if len(s) else 1.0
    inverse = (vt.T / np.maximum(s, floor)) @ u.T
    blind = (np.abs(vt[s <= floor]) > BLIND).any(axis=0)
    inverse[blind] = np.inf
    return q, inverse / d[:, None], condition


def _unknowable(spread: Array, covariance: Array) -> Array:
    """Infinite variance, no covariance, for the parameters that no sample shows."""
    blind = ~np.isfinite(spread).all(axis=1)
    covariance = 0.5 * (covariance + covariance.T)
    covariance[blind, :] = covariance[:, blind] = 0.0
    covariance[blind, blind] = np.inf
    return covariance


def _projected(problem: Problem, by_p: Array, by_x: Array) -> Array:
    """The weighted parameter Jacobian with each horizon's initial state projected out, (w, H, n_y, n)."""
    used = problem.windows.used[..., None, None]
    weight = np.where(used, 1.0 / problem.scale[:, None], 0.0)
    jp, jx = by_p * weight, by_x * weight
    if not problem.estimate_x0:
        return jp
    w, length, n_y, n = jp.shape
    tall_x, tall_p = jx.reshape(w, length * n_y, -1), jp.reshape(w, length * n_y, n)
    norms = np.linalg.norm(tall_x, axis=1, keepdims=True)
    basis, _ = np.linalg.qr(tall_x / np.where(norms > 0, norms, 1.0))
    return (tall_p - basis @ (basis.swapaxes(1, 2) @ tall_p)).reshape(jp.shape)


def _sandwich(jacobian: Array, residual: Array, used: NDArray[np.bool_]) -> Array:
    """``J' Sigma J`` for one output: (w, H, n), (w, H) -> (n, n)."""
    pieces = [row[keep] for row, keep in zip(residual, used, strict=True)]
    coefficients, innovation = autoregression(pieces)
    size = 2 * jacobian.shape[1]
    transform = np.fft.rfft(jacobian, size, axis=1)
    response = np.fft.rfft(np.concatenate([[1.0], -coefficients]), size)
    spectrum = innovation / np.abs(response) ** 2
    weight = np.full(len(spectrum), 2.0 / size)
    weight[0] = weight[-1] = 1.0 / size
    return np.einsum("wfi,f,wfj->ij", transform.conj(), spectrum * weight, transform).real


def autoregression(pieces: Sequence[Array]) -> tuple[Array, float]:
    """Autoregression of a residual in pieces: coefficients (order,) and innovation variance.

    Yule-Walker on the pooled autocovariance, always stable; the order minimises BIC.
    """
    total = sum(len(piece) for piece in pieces)
    most = min(MOST_LAGS, min(len(piece) for piece in pieces) // 4, total // 20)
    covariance = np.array([_autocovariance(pieces, lag) for lag in range(most + 1)]) / max(total, 1)
    best = (np.zeros(0), covariance[0])
    if covariance[0] <= 0:
        return best
    lowest = total * np.log(covariance[0])
    for order in range(1, most + 1):
        a = solve_toeplitz(covariance[:order], covariance[1 : order + 1])
        variance = float(covariance[0] - a @ covariance[1 : order + 1])
        if variance <= 0:
            break
        criterion = total * np.log(variance) + order * np.log(total)
        if criterion < lowest:
            lowest, best = criterion, (a, variance)
    return best


def _autocovariance(pieces: Sequence[Array], lag: int) -> float:
    return sum(float(piece[lag:] @ piece[: len(piece) - lag]) for piece in pieces if len(piece) > lag)
