"""``fit``: a model and records in, an ``Estimate`` out."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from hybridid.estimators.carried import carries_nothing, carry
from hybridid.estimators.estimate import Estimate, Progress, Solution
from hybridid.estimators.findings import SAME_OPTIMUM, estimate_of
from hybridid.estimators.ipopt import Ipopt
from hybridid.estimators.method import GAUSS_NEWTON, Method
from hybridid.estimators.multiple_shooting import MultipleShooting
from hybridid.estimators.problem import Problem, build_problem
from hybridid.estimators.short_horizons import short_horizon_problem, short_horizon_start
from hybridid.estimators.start import best_initial_states, regression_start, scattered, x0_candidates
from hybridid.estimators.stop import Stop, Watch
from hybridid.estimators.uncertainty import uncertainty
from hybridid.model import Model
from hybridid.records.record import Record
from hybridid.settings.fit import FitSettings
from hybridid.simulation.matching import check_records
from hybridid.simulation.stability import MOST, first_substeps, substeps_wanted

Array = NDArray[np.float64]
HANDOVERS = 4
"""How often the effects' inner states are handed on and the fit goes on from there."""
COARSE, EXACT = 0.05, 1e-9
"""Share of the residual that halving the steps may move it by; a residual that is none."""
REFINEMENTS = 3
"""How often a fit that ends where the integrator needs shorter steps goes on with them."""


def fit(
    model: Model,
    records: Sequence[Record],
    settings: FitSettings | None = None,
    progress: Callable[[Progress], None] | None = None,
    start_values: Mapping[str, float] | None = None,
) -> Estimate:
    """Fit the free parameters of ``model`` to ``records``.

    Minimises the output error over the horizons that ``settings`` lays out, from one or
    several starts, and keeps the lowest cost. ``start_values`` (by qualified name)
    replaces the automatic start.

    Raises:
        ValueError: if a record does not fit the model, nothing is free to estimate, the
            model is too stiff, or it diverges from every start.
    """
    settings = settings or FitSettings()
    began = time.perf_counter()
    if not model.free:
        raise ValueError("every parameter is fixed: nothing to estimate")
    check_records(model, records)
    first = _first_start(model, records, settings, start_values)
    substeps = settings.substeps or first_substeps(model, first, records, settings.integrator)
    problem = _problem(model, records, settings, substeps)
    blind = start_values is None and settings.start == "regression"
    short = short_horizon_problem(problem) if blind else None
    built = time.perf_counter()
    starts = scattered(model, first, settings.starts, settings.seed)
    found = [_solve(problem, short, p, settings, progress, (k, len(starts))) for k, p in enumerate(starts)]
    best = min(found, key=lambda solution: solution.cost)
    if not np.isfinite(best.cost):
        raise ValueError(
            f"the model diverges from every start on {', '.join(r.name for r in records)}: {best.status}"
        )
    if settings.substeps is None:
        problem, best = _refined(problem, best, settings, progress)
    solved = time.perf_counter()
    return estimate_of(
        problem,
        best,
        uncertainty(problem, best.p, best.x0),
        settings,
        seconds={"build": built - began, "solve": solved - built},
        starts=tuple(solution.cost for solution in found),
    )


def _problem(model: Model, records: Sequence[Record], settings: FitSettings, substeps: int) -> Problem:
    estimate_x0 = settings.initial_state == "estimated"
    return build_problem(
        model, records, settings.horizon, substeps, estimate_x0, integrator=settings.integrator
    )


def _refined(
    problem: Problem,
    solution: Solution,
    settings: FitSettings,
    progress: Callable[[Progress], None] | None,
) -> tuple[Problem, Solution]:
    """The solution with steps as short as it needs itself: stable, and not seen in the residual."""
    for _ in range(REFINEMENTS):
        needed = _steps_needed(problem, solution, settings)
        if not problem.windows.substeps < needed <= MOST:
            break
        finer = _problem(problem.model, problem.records, settings, needed)
        watch = _reporter(progress, f"fit with {needed} steps a sample", 1.0)
        again = _descend(finer, solution.p, solution.x0, settings, (1.0,), watch)
        if not np.isfinite(again.cost):
            break
        problem, solution = finer, _after(solution, again, again)
    return problem, solution


def _steps_needed(problem: Problem, solution: Solution, settings: FitSettings) -> int:
    """Steps a sample that are stable at the solution; twice those in use if halving them shows.

    The error of a step may not be a noticeable part of the residual: the parameters would
    follow it.
    """
    now = problem.windows.substeps
    stable = substeps_wanted(problem.model, solution.p, problem.records, integrator=settings.integrator)
    if stable > now:
        return stable
    finer = _problem(problem.model, problem.records, settings, 2 * now)
    r, closer = (q.residuals(q.shooter(solution.x0, solution.p)) for q in (problem, finer))
    return 2 * now if np.linalg.norm(closer - r) > COARSE * np.linalg.norm(r) > EXACT else now


def _reporter(
    progress: Callable[[Progress], None] | None, stage: str, fraction: float
) -> Callable[[int, float], None]:
    return lambda iteration, cost: progress(Progress(stage, iteration, cost, fraction)) if progress else None


def _first_start(
    model: Model, records: Sequence[Record], settings: FitSettings, given: Mapping[str, float] | None
) -> Array:
    if given is not None:
        return model.values(given)
    regressed = regression_start(model, records) if settings.start == "regression" else None
    return model.values() if regressed is None else regressed


def _solve(
    problem: Problem,
    short: Problem | None,
    p: Array,
    settings: FitSettings,
    progress: Callable[[Progress], None] | None,
    place: tuple[int, int],
) -> Solution:
    """One start: short horizons where they help, choose initial states, descend, then look
    whether a horizon was trapped."""
    index, count = place
    stage = "fit" if count == 1 else f"start {index + 1} of {count}"
    watch = _reporter(progress, stage, index / count)
    if short is not None:
        p = short_horizon_start(short, p, settings.continuation[0], watch)
    candidates = x0_candidates(problem, p) if problem.estimate_x0 else [problem.measured_x0()]
    solution = _descend(
        problem, p, best_initial_states(problem, p, candidates), settings, settings.continuation, watch
    )
    if not np.isfinite(solution.cost):
        return solution
    freed = best_initial_states(problem, solution.p, [solution.x0, *candidates])
    if not np.array_equal(freed, solution.x0):
        again = _descend(problem, solution.p, freed, settings, (1.0,), watch)
        solution = _after(solution, again if again.cost < solution.cost else solution, again)
    return _carried(problem, solution, settings, watch)


def _carried(
    problem: Problem, solution: Solution, settings: FitSettings, watch: Callable[[int, float], None]
) -> Solution:
    """The solution with the effects' inner states handed on from horizon to horizon, as Gauss-Newton has
    them anyway."""
    if carries_nothing(problem) or settings.method == "gauss_newton":
        return solution
    for _ in range(HANDOVERS):
        x0 = carry(problem, solution.p, solution.x0)
        before, again = solution, _descend(problem, solution.p, x0, settings, (1.0,), watch)
        solution = _after(before, again, again)
        if abs(solution.cost - before.cost) <= SAME_OPTIMUM * before.cost:
            break
    return solution


def _after(first: Solution, kept: Solution, second: Solution) -> Solution:
    """``kept``, with the iterations of two descents."""
    return replace(kept, iterations=first.iterations + second.iterations)


def _descend(
    problem: Problem,
    p: Array,
    x0: Array,
    settings: FitSettings,
    factors: Sequence[float],
    watch: Watch,
) -> Solution:
    stop = Stop(settings.max_iterations, settings.tolerance)
    return method_of(settings).solve(problem, p, x0, factors, stop, watch)


def method_of(settings: FitSettings) -> Method:
    """Transcription and solver that ``estimator.method`` names."""
    if settings.method == "gauss_newton":
        return GAUSS_NEWTON
    return Method(MultipleShooting(settings.interval), Ipopt(settings.hessian))
