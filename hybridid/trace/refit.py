"""Refit a model on the fitted horizons and score it on the held-out ones.

All parameters are refitted together: an effect left out has moved every one of them, so a
candidate tried with the others frozen is judged by the wrong model.
"""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.signal import lfilter

from hybridid.estimators import gauss_newton
from hybridid.estimators.estimate import Solution
from hybridid.estimators.problem import Problem, build_problem
from hybridid.estimators.start import at_rest, best_initial_states, x0_candidates
from hybridid.estimators.uncertainty import autoregression, uncertainty
from hybridid.model import Model
from hybridid.records.record import Hold
from hybridid.simulation.stability import substeps_for
from hybridid.trace.split import Split

Array = NDArray[np.float64]
GLANCE = 8
"""Iterations spent on each start before the best is carried to convergence."""
MOST_ITERATIONS = 40


@dataclass(frozen=True)
class Numerics:
    """How the equations are solved; a verdict must not depend on it.

    ``smoothing`` multiplies every port's epsilon, ``finer`` the steps a sample;
    ``hold`` replaces how every input runs between samples (None: as declared).
    """

    name: str = "as declared"
    smoothing: float = 1.0
    finer: int = 1
    integrator: str = "rk4"
    hold: Hold | None = None


DECLARED = Numerics()


@dataclass(frozen=True)
class Score:
    """Held-out evidence by horizon, shapes (h, n_y).

    ``squares`` sums of squared errors in units², ``samples`` how many; ``likelihood`` the
    Gaussian log-likelihood of the errors whitened by an autoregression that was fitted to
    the model's own residual on the fitted horizons. ``scale`` (n_y,) is each output's
    standard deviation over the records.
    """

    squares: Array
    samples: Array
    likelihood: Array
    scale: Array

    @property
    def rmse(self) -> Array:
        """Root mean square error of each output, (n_y,), in the output's unit."""
        return np.sqrt(self.squares.sum(axis=0) / self.samples.sum(axis=0))

    @property
    def loss(self) -> float:
        """One number for all outputs: RMSE of the errors over their output's scale."""
        return float(np.sqrt(np.mean((self.rmse / self.scale) ** 2)))


@dataclass(frozen=True)
class Refit:
    """A model fitted on the split's fitted horizons, and its score on the held-out ones."""

    model: Model
    values: Mapping[str, float]
    std: Mapping[str, float]
    correlation: Array
    fitted_x0: Array
    held_x0: Array
    fitted_rmse: Array
    score: Score
    cost: float
    status: str
    converged: bool
    seconds: float


def refit(
    model: Model,
    split: Split,
    starts: Sequence[Mapping[str, float]] = ({},),
    before: Refit | None = None,
    numerics: Numerics = DECLARED,
    factors: Sequence[float] = (1.0,),
) -> Refit:
    """Fit ``model`` from the best of ``starts`` (values by name over guesses) and score it.

    ``before`` lends its initial states. ``factors`` is the continuation in epsilon.
    """
    began = time.perf_counter()
    problem = problem_of(model, split, numerics, starts[0])
    fitted, held = problem.on(split.fitted), problem.on(split.held_out)
    x0 = _initial(fitted, None if before is None else before.fitted_x0)
    begun = [problem.smoothed(model.values(s), numerics.smoothing) for s in starts]
    solution = _best(fitted, x0, begun, factors, numerics, before is None)
    held_x0 = _initial(held, None if before is None else before.held_x0)
    judged = held.estimating(())
    _, held_x0 = _from(judged, solution.p, held_x0, before is None)
    held_x0 = gauss_newton.solve(judged, solution.p, held_x0, (numerics.smoothing,)).x0
    doubt = uncertainty(fitted, solution.p, solution.x0)
    ours, theirs = _errors(fitted, solution.p, solution.x0), _errors(judged, solution.p, held_x0)
    return Refit(
        model=model,
        values={q.name: float(v) for q, v in zip(model.parameters, solution.p, strict=True)},
        std=dict(zip(fitted.free, doubt.std.tolist(), strict=True)),
        correlation=doubt.correlation,
        fitted_x0=solution.x0,
        held_x0=held_x0,
        fitted_rmse=np.sqrt(sum((e**2).sum(axis=0) for e in ours) / sum(len(e) for e in ours)),
        score=_score(ours, theirs, problem.scale),
        cost=solution.cost,
        status=solution.status,
        converged=solution.converged,
        seconds=time.perf_counter() - began,
    )


def problem_of(model: Model, split: Split, numerics: Numerics, start: Mapping[str, float]) -> Problem:
    """Every horizon of ``split`` as a problem, solved as ``numerics`` say; steps are chosen at ``start``."""
    records = split.records
    if numerics.hold is not None:
        records = tuple(
            replace(
                r, input_channels=tuple(replace(c, hold=numerics.hold) for c in r.input_channels), warnings=()
            )
            for r in records
        )
    p = model.values(start)
    substeps = substeps_for(model, p, records, margin=1.1) * numerics.finer
    problem = build_problem(model, records, split.horizon, substeps, integrator=numerics.integrator)
    return problem.without_ends(split.gap)


def _initial(problem: Problem, lent: Array | None) -> Array:
    """Initial states: those lent by a model with fewer states, or the measured ones."""
    measured = problem.measured_x0()
    if lent is None:
        return measured
    measured[:, : min(lent.shape[1], measured.shape[1])] = lent[:, : measured.shape[1]]
    return measured


def _best(
    problem: Problem,
    x0: Array,
    starts: Sequence[Array],
    factors: Sequence[float],
    numerics: Numerics,
    alone: bool,
) -> Solution:
    """The lowest descent over the starts: a glance at each, then the best to convergence."""
    smoothing = [factor * numerics.smoothing for factor in factors]
    first = [_from(problem, p, x0, alone) for p in starts]
    if len(first) > 1:
        glances = [gauss_newton.solve(problem, p, x, smoothing[-1:], GLANCE, 1e-3) for p, x in first]
        best = min(glances, key=lambda solution: solution.cost)
        first, smoothing = [(best.p, best.x0)], smoothing[-1:]
    p, x = first[0]
    return gauss_newton.solve(problem, p, x, smoothing, MOST_ITERATIONS)


def _from(problem: Problem, p: Array, x0: Array, alone: bool) -> tuple[Array, Array]:
    """A start with its best initial states; ``alone`` no poorer model lends any."""
    candidates = x0_candidates(problem, p) if alone else [problem.measured_x0(), at_rest(problem, x0)]
    return p, best_initial_states(problem, p, [x0, *candidates])


def _errors(problem: Problem, p: Array, x0: Array) -> list[Array]:
    """Output errors of each horizon, list of (n_k, n_y), in the outputs' units."""
    r = problem.residuals(problem.shooter(x0, p)) * problem.scale
    return [row[used] for row, used in zip(r, problem.windows.used, strict=True)]


def _score(fitted: Sequence[Array], held_out: Sequence[Array], scale: Array) -> Score:
    n_y = held_out[0].shape[1]
    columns = [_whitened([e[:, k] for e in fitted], [e[:, k] for e in held_out]) for k in range(n_y)]
    return Score(
        squares=np.array([(e**2).sum(axis=0) for e in held_out]),
        samples=np.array([[len(e)] * n_y for e in held_out]),
        likelihood=np.stack(columns, axis=1),
        scale=scale,
    )


def _whitened(fitted: Sequence[Array], held_out: Sequence[Array]) -> Array:
    """Gaussian log-likelihood of each held-out row under the fitted residual's autoregression."""
    coefficients, variance = autoregression(fitted)
    if variance <= 0:
        return np.full(len(held_out), np.inf)
    taps, order = np.concatenate([[1.0], -coefficients]), len(coefficients)
    innovations = [lfilter(taps, [1.0], row)[order:] for row in held_out]
    return np.array([-0.5 * np.sum(e**2 / variance + np.log(2 * np.pi * variance)) for e in innovations])
