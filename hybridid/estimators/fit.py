"""``fit``: a model and records in, an ``Estimate`` out."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from hybridid.estimators.descent import Finer, descend, refine
from hybridid.estimators.elsewhere import CLEARLY, elsewhere
from hybridid.estimators.estimate import Estimate, Progress, Solution
from hybridid.estimators.findings import estimate_of
from hybridid.estimators.floor import Floor, floor_of
from hybridid.estimators.ipopt import Ipopt
from hybridid.estimators.method import MENDING, Method
from hybridid.estimators.multiple_shooting import MultipleShooting
from hybridid.estimators.plan import Descent, Handover, Refinement, Result, Start
from hybridid.estimators.problem import Problem, build_problem
from hybridid.estimators.robust import Clipped, reweighted
from hybridid.estimators.short_horizons import short_horizon_problem, short_horizon_start
from hybridid.estimators.start import best_initial_states, regression_start, scattered, x0_candidates
from hybridid.estimators.stop import Stop, Watch
from hybridid.estimators.uncertainty import Uncertainty, uncertainty
from hybridid.model import Model
from hybridid.records.record import Record
from hybridid.settings.fit import FitSettings
from hybridid.simulation.chosen import AUTO, as_integrator, integrator_for
from hybridid.simulation.matching import check_records
from hybridid.simulation.stability import IMPLICIT, MOST, first_substeps, substeps_wanted

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
    start_states: Array | None = None,
) -> Estimate:
    """Fit the free parameters of ``model`` to ``records``.

    Minimises the output error over the horizons that ``settings`` lays out, from one or
    several starts, and keeps the lowest cost. With the loss "huber" it goes on from there
    (``robust``). ``start_values`` (by qualified name) replaces the automatic start. ``start_states`` (w, n_x)
    are initial states of the horizons to start from where they fit better than those at hand.

    Raises:
        ValueError: if a record does not fit the model, an output never changes, nothing is free to estimate,
        the model is too stiff, or it diverges from every start.
    """
    settings = settings or FitSettings()
    began = time.perf_counter()
    if not model.free:
        raise ValueError("every parameter is fixed: nothing to estimate")
    check_records(model, records)
    _check_outputs(records)
    first = _first_start(model, records, settings, start_values)
    left_open = settings.integrator == AUTO
    settings = replace(settings, integrator=integrator_for(model, first, records, settings.integrator))
    substeps = settings.substeps or first_substeps(model, first, records, settings.integrator)
    problem = _problem(model, records, settings, substeps)
    blind = start_values is None and settings.start == "regression"
    short = short_horizon_problem(problem) if blind else None
    built = time.perf_counter()
    plan = descent_of(settings)
    values = scattered(model, first, settings.starts, settings.seed)
    found = descend(_starts(problem, short, values, settings, progress, start_states), plan)
    if not np.isfinite(found.solution.cost):
        names = ", ".join(r.name for r in records)
        raise ValueError(f"the model diverges from every start on {names}: {found.solution.status}")
    finer = partial(_finer, settings, left_open, progress) if settings.substeps is None else None
    found = refine(found, plan, finer) if finer else found
    solved = time.perf_counter()
    found, doubt, floor = _lowest(found, plan, finer, [first, model.values()], progress)
    if settings.loss == "huber":
        found = reweighted(found, plan, _reporter(progress, "reweighted fit", 1.0))
        doubt, floor = _doubt(found, Clipped.of(found.problem, found.solution).pseudo)
    looked = time.perf_counter()
    return estimate_of(
        found.problem,
        found.solution,
        doubt,
        floor,
        replace(settings, integrator=as_integrator(found.problem.shooter.integrator)),
        seconds={"build": built - began, "solve": solved - built, "check": looked - solved},
        starts=found.starts,
    )


def _check_outputs(records: Sequence[Record]) -> None:
    """Refuse outputs that say nothing: a fit to them would look perfect."""
    names = " and ".join(record.name for record in records)
    for k, channel in enumerate(records[0].output_channels):
        samples = np.concatenate([record.counted[:, k] for record in records])
        samples = samples[np.isfinite(samples)]
        if not np.ptp(samples) > 0:
            raise ValueError(
                f"output {channel.name} of {names} is {samples[0]:.6g} {channel.unit} at every sample: "
                "there is nothing to fit; is the sensor dead, or the column another one?"
            )


def _lowest(
    found: Result,
    plan: Descent,
    finer: Finer | None,
    starts: Sequence[Array],
    progress: Callable[[Progress], None] | None,
) -> tuple[Result, Uncertainty, Floor]:
    """``found``, or where a second descent ends at clearly lower cost; its uncertainty, and what noise and
    simulation leave there. Where the first leaves no more than they do, none is made."""
    doubt, floor = _doubt(found)
    if not floor.exceeded.any():
        return found, doubt, floor
    other = elsewhere(found, plan, starts, _reporter(progress, "second descent, from elsewhere", 1.0))
    if other is None:
        return found, doubt, floor
    costs = (*found.starts, other.solution.cost)
    if other.solution.cost > CLEARLY * found.solution.cost:
        return replace(found, starts=costs), doubt, floor
    other = replace(refine(other, plan, finer) if finer else other, starts=costs)
    return other, *_doubt(other)


def _doubt(found: Result, residual: Array | None = None) -> tuple[Uncertainty, Floor]:
    problem, best = found.problem, found.solution
    shot = problem.shooter(best.x0, best.p, sensitivities=True)
    doubt = uncertainty(problem, best.p, best.x0, residual, shot)
    return doubt, floor_of(problem, best.p, best.x0, doubt.smeared, residual, shot)


def method_of(settings: FitSettings) -> Method:
    """Transcription and solver that ``settings.method`` names."""
    if settings.method == "gauss_newton":
        return MENDING
    return Method(MultipleShooting(settings.interval), Ipopt(settings.hessian))


def descent_of(settings: FitSettings) -> Descent:
    """The descent of a fit: each start is carried to the end, and steps are refined up to thrice."""
    stop = Stop(settings.max_iterations, settings.tolerance)
    return Descent(
        handover=Handover(HANDOVERS, stop),
        refinement=Refinement(REFINEMENTS, Handover(0, stop), must_hold=True),
        method=method_of(settings),
        continuation=settings.continuation,
        stop=stop,
        cost_limit=np.finfo(float).max,
    )


def _problem(model: Model, records: Sequence[Record], settings: FitSettings, substeps: int) -> Problem:
    estimate_x0 = settings.initial_state == "estimated"
    return build_problem(
        model, records, settings.horizon, substeps, estimate_x0, integrator=settings.integrator
    )


def _finer(
    settings: FitSettings, left_open: bool, progress: Callable[[Progress], None] | None, found: Result
) -> Start | None:
    """The solution in steps as short as it needs itself: stable, and not seen in the residual.

    Where the integrator is ``left_open`` and the explicit one would need more than ``MOST``, by the implicit
    one.
    """
    problem, solution = found.problem, found.solution
    settings = replace(settings, integrator=as_integrator(problem.shooter.integrator))
    stage = "fit"
    needed = _steps_needed(problem, solution, settings)
    if left_open and needed > MOST and settings.integrator != IMPLICIT:
        settings, stage = replace(settings, integrator=IMPLICIT), f"fit by {IMPLICIT}"
        needed = first_substeps(problem.model, solution.p, problem.records, IMPLICIT)
    elif not problem.windows.substeps < needed <= MOST:
        return None
    watch = _reporter(progress, f"{stage} with {needed} steps a sample", 1.0)
    finer = _problem(problem.model, problem.records, settings, needed)
    return Start(finer, solution.p, solution.x0, watch=watch)


def _steps_needed(problem: Problem, solution: Solution, settings: FitSettings) -> int:
    """Steps a sample that are stable at the solution; twice those in use if halving them shows.

    The error of a step may not be a noticeable part of the residual: the parameters would
    follow it.
    """
    now = problem.windows.substeps
    stable = substeps_wanted(problem.model, solution.p, problem.records, integrator=settings.integrator)
    if stable > now:
        return stable
    r, moved = problem.moved_by_half_the_step(solution.x0, solution.p)
    return 2 * now if np.linalg.norm(moved) > COARSE * np.linalg.norm(r) > EXACT else now


def _reporter(progress: Callable[[Progress], None] | None, stage: str, fraction: float) -> Watch:
    return lambda iteration, cost: progress(Progress(stage, iteration, cost, fraction)) if progress else None


def _first_start(
    model: Model, records: Sequence[Record], settings: FitSettings, given: Mapping[str, float] | None
) -> Array:
    if given is not None:
        return model.values(given)
    regressed = regression_start(model, records) if settings.start == "regression" else None
    return model.values() if regressed is None else regressed


def _starts(
    problem: Problem,
    short: Problem | None,
    values: Sequence[Array],
    settings: FitSettings,
    progress: Callable[[Progress], None] | None,
    states: Array | None,
) -> Iterator[Start]:
    """A start at each of ``values`` (n_p,), improved over short horizons where they help, from the best
    initial states at hand, ``states`` (w, n_x) among them."""
    for k, p in enumerate(values):
        stage = "fit" if len(values) == 1 else f"start {k + 1} of {len(values)}"
        watch = _reporter(progress, stage, k / len(values))
        if short is not None:
            p = short_horizon_start(short, p, settings.continuation[0], watch)
        candidates = x0_candidates(problem, p) if problem.estimate_x0 else [problem.measured_x0()]
        if states is not None and problem.estimate_x0:
            candidates.append(states)
        yield Start(problem, p, best_initial_states(problem, p, candidates), tuple(candidates), watch)
