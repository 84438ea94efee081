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

from hybridid.estimators import gauss_newton
from hybridid.estimators.carried import carries_nothing, carry
from hybridid.estimators.estimate import Solution
from hybridid.estimators.problem import Problem, build_problem
from hybridid.estimators.start import at_rest, best_initial_states, x0_candidates
from hybridid.estimators.uncertainty import uncertainty
from hybridid.model import Model
from hybridid.records.record import Hold
from hybridid.simulation.stability import MOST, substeps_wanted
from hybridid.trace.score import Score, score_of
from hybridid.trace.split import Split

Array = NDArray[np.float64]
GLANCE = 8
"""Iterations spent on each start before the best is carried to convergence."""
GLANCE_TOLERANCE = 1e-3
MOST_ITERATIONS = 40
HANDOVERS = 3
SETTLED = 1e-3
"""Relative change of the cost below which handing inner states on changes nothing more."""
MARGIN = 1.1
STIFF = 8
"""Steps a sample beyond which a start is left to those that are less stiff."""


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
class Refit:
    """A model fitted on the split's fitted horizons, and its score on the held-out ones.

    ``x0`` (w, n_x) are the initial states of all horizons, fitted and held out.
    """

    model: Model
    values: Mapping[str, float]
    std: Mapping[str, float]
    correlation: Array
    x0: Array
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
    problem = problem_of(model, split, numerics, *starts)
    x0 = _initial(problem, before)
    p, x0 = _best_start(problem, split, starts, x0, before is None, numerics)
    solution, x0 = _settled(problem, split, p, x0, [factor * numerics.smoothing for factor in factors])
    fitted, judged = problem.on(split.fitted), problem.on(split.held_out).estimating(())
    doubt = uncertainty(fitted, solution.p, solution.x0)
    ours = _errors(fitted, solution.p, solution.x0)
    theirs = _errors(judged, solution.p, x0[list(split.held_out)])
    return Refit(
        model=model,
        values={q.name: float(v) for q, v in zip(model.parameters, solution.p, strict=True)},
        std=dict(zip(fitted.free, doubt.std.tolist(), strict=True)),
        correlation=doubt.correlation,
        x0=x0,
        fitted_rmse=np.sqrt(sum((e**2).sum(axis=0) for e in ours) / sum(len(e) for e in ours)),
        score=score_of(ours, theirs, problem.scale),
        cost=solution.cost,
        status=solution.status,
        converged=solution.converged,
        seconds=time.perf_counter() - began,
    )


def problem_of(model: Model, split: Split, numerics: Numerics, *starts: Mapping[str, float]) -> Problem:
    """Every horizon of ``split`` as a problem, solved as ``numerics`` say.

    The steps suit the stiffest of ``starts`` that ``STIFF`` of them can follow.
    """
    records = split.records
    if numerics.hold is not None:
        hold = numerics.hold
        records = tuple(
            replace(r, input_channels=tuple(replace(c, hold=hold) for c in r.input_channels), warnings=())
            for r in records
        )
    wanted = [
        substeps_wanted(model, model.values(start), records, MARGIN, numerics.integrator) for start in starts
    ]
    substeps = max((steps for steps in wanted if steps <= STIFF), default=min(wanted))
    if substeps > MOST:
        raise ValueError(f"needs more than {MOST} steps a sample at every start")
    problem = build_problem(
        model, records, split.horizon, substeps * numerics.finer, integrator=numerics.integrator
    )
    return problem.without_ends(split.gap)


def _initial(problem: Problem, before: Refit | None) -> Array:
    """Initial states (w, n_x): those of the poorer model, or the measured ones."""
    measured = problem.measured_x0()
    if before is not None:
        names = [s.name for s in problem.model.states]
        for column, state in enumerate(before.model.states):
            if state.name in names:
                measured[:, names.index(state.name)] = before.x0[:, column]
    return measured


def _chosen(problem: Problem, p: Array, x0: Array, alone: bool) -> Array:
    """For each horizon the best of the initial states at hand; ``alone``: no poorer model lends any."""
    candidates = x0_candidates(problem, p) if alone else [problem.measured_x0(), at_rest(problem, x0)]
    return best_initial_states(problem, p, [x0, *candidates])


def _best_start(
    problem: Problem,
    split: Split,
    starts: Sequence[Mapping[str, float]],
    x0: Array,
    alone: bool,
    numerics: Numerics,
) -> tuple[Array, Array]:
    """The start whose first iterations get furthest: its parameters and all initial states."""
    fitted, rows = problem.on(split.fitted), list(split.fitted)
    found: list[tuple[float, Array, Array]] = []
    for start in starts:
        p = problem.smoothed(problem.model.values(start), numerics.smoothing)
        begun = carry(problem, p, _chosen(problem, p, x0, alone))
        if len(starts) == 1:
            return p, begun
        glance = gauss_newton.solve(fitted, p, begun[rows], (numerics.smoothing,), GLANCE, GLANCE_TOLERANCE)
        found.append((glance.cost, glance.p, _with(begun, rows, glance.x0)))
    _, p, begun = min(found, key=lambda one: one[0])
    return p, begun


def _settled(
    problem: Problem, split: Split, p: Array, x0: Array, smoothing: Sequence[float]
) -> tuple[Solution, Array]:
    """Converged parameters, and the initial states of all horizons at them.

    Where effects have inner states, these are handed on and the fit goes on, until both agree.
    """
    fitted, judged = problem.on(split.fitted), problem.on(split.held_out).estimating(())
    ours, theirs = list(split.fitted), list(split.held_out)
    solution = gauss_newton.solve(fitted, p, x0[ours], smoothing, MOST_ITERATIONS)
    for _ in range(HANDOVERS):
        x0 = _with(x0, ours, solution.x0)
        x0 = _with(x0, theirs, gauss_newton.solve(judged, solution.p, x0[theirs], smoothing[-1:]).x0)
        if carries_nothing(problem):
            break
        x0, before = carry(problem, solution.p, x0), solution.cost
        solution = gauss_newton.solve(fitted, solution.p, x0[ours], smoothing[-1:], MOST_ITERATIONS)
        if abs(before - solution.cost) <= SETTLED * solution.cost:
            x0 = _with(x0, ours, solution.x0)
            x0 = _with(x0, theirs, gauss_newton.solve(judged, solution.p, x0[theirs], smoothing[-1:]).x0)
            break
    return solution, x0


def _with(x0: Array, rows: Sequence[int], values: Array) -> Array:
    changed = np.array(x0)
    changed[list(rows)] = values
    return changed


def _errors(problem: Problem, p: Array, x0: Array) -> list[Array]:
    """Output errors of each horizon, list of (n_k, n_y), in the outputs' units."""
    r = problem.residuals(problem.shooter(x0, p)) * problem.scale
    return [row[used] for row, used in zip(r, problem.windows.used, strict=True)]
