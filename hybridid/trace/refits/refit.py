"""Refit a model on the fitted horizons and score it on the held-out ones.

All parameters are refitted together: an effect that is left out biases every one of them, so a
candidate tried with the others frozen would be judged by the wrong model.
"""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from hybridid.estimators.descent import descend, go_on, refine
from hybridid.estimators.estimate import Solution
from hybridid.estimators.plan import Descent, Handover, Refinement, Result, Start
from hybridid.estimators.problem import Problem, paths
from hybridid.estimators.stop import Stop
from hybridid.estimators.uncertainty import uncertainty
from hybridid.model import Model
from hybridid.simulation.simulate import Diverged
from hybridid.simulation.stability import TooStiff
from hybridid.trace.horizons.scored import scored
from hybridid.trace.horizons.split import Split
from hybridid.trace.refits.numerics import DECLARED, Numerics
from hybridid.trace.refits.refit_starts import is_too_stiff, room_beside, starts_of
from hybridid.trace.refits.refitted import Refit

Array = NDArray[np.float64]
SCREENING = Stop(5, 1e-3)
"""Ends the short descent from each of several starts, once at the widest and once at the narrowest smoothing.
Only the best start then descends to convergence."""
MOST_ITERATIONS, TOLERANCE = 40, 1e-6
CONTINUATION = (10.0, 3.0, 1.0)
"""Smoothings of sign(v), one after the other. With a sharp sign(v) the cost has many local minima."""
HANDOVERS, HANDOVER_ITERATIONS = 3, 12
LEAST_DECREASE = 0.02
"""Share by which an effect must lower the fitted cost before inner states are handed on, and before its refit
goes on after the short descents."""
WITHOUT_STD = -np.inf
"""``std_up_to`` of a refit whose standard errors nothing reads."""
FAILURES = (Diverged, ArithmeticError, np.linalg.LinAlgError)
"""Other errors of a model that cannot be simulated."""


@np.errstate(over="ignore", invalid="ignore")  # a simulation that diverges has an infinite cost
def refit(
    model: Model,
    split: Split,
    starts: Sequence[Mapping[str, float]] = ({},),
    before: Refit | None = None,
    numerics: Numerics = DECLARED,
    factors: Sequence[float] = (1.0,),
    tolerance: float = TOLERANCE,
    std_up_to: float = np.inf,
    hopeful: float = np.inf,
    surprising: float = -np.inf,
) -> Refit:
    """Fit ``model`` from the best of ``starts`` (values by name over guesses) and score it.

    ``before`` lends its initial states. ``factors`` is the continuation in epsilon; ``tolerance``
    as ``Stop`` has it. Standard errors are computed if the held-out loss is at most ``std_up_to``. It
    ends early, without standard errors, if even the best start promises no fitted cost below ``hopeful``, and
    its held-out loss so far is not below ``surprising``.

    Raises:
        TooStiff: if the model is, at every start.
    """
    began = time.perf_counter()
    cost_limit = np.inf if before is None else (1 - LEAST_DECREASE) * before.cost
    screened = len(starts) > 1 or hopeful < np.inf
    plan = replace(_descent(numerics, factors, tolerance, screened, cost_limit), hopeful=hopeful)

    def steps_at(found: Result) -> int:
        p = found.solution.p
        return numerics.steps(model, p, split, paths(found.problem, p, found.x0))

    def finer(found: Result) -> Start | None:
        needed = min(wanted, room)
        if needed * numerics.finer <= found.problem.windows.substeps:
            return None
        return Start(numerics.problem(model, split, needed), found.solution.p, found.x0)

    room = room_beside(before)
    remembers = before is not None and len(model.states) > len(before.model.states)
    begun = starts_of(model, split, starts, before, numerics)
    first = descend(list(begun.values()), plan, split.fitted)
    early = scored(first, split) if first.ended_early else None
    if early and early[0].loss < surprising:
        first, early = go_on(first, plan, split.fitted), None
    solved = [k for n, k in enumerate(begun) if not (remembers and n in first.diverged)]
    wanted = steps_at(first)
    found = refine(first, plan, finer, split.fitted)
    wanted = wanted if found is first else steps_at(found)
    solution = found.solution
    score, fitted_rmse = early or scored(found, split)
    std, correlation = (
        _standard_errors(found.problem.on(split.fitted), solution)
        if score.loss <= std_up_to and not found.ended_early
        else ({}, np.empty((0, 0)))
    )
    return Refit(
        model=model,
        values={q.name: float(v) for q, v in zip(model.parameters, solution.p, strict=True)},
        std=std,
        correlation=correlation,
        x0=found.x0,
        fitted_rmse=fitted_rmse,
        score=score,
        cost=solution.cost,
        status=solution.status,
        converged=solution.converged,
        seconds=time.perf_counter() - began,
        substeps=found.problem.windows.substeps,
        numerics=numerics,
        unsolved=tuple(k for k in range(len(starts)) if k not in solved),
        too_stiff=is_too_stiff(wanted, before, numerics),
        ended_early=found.ended_early,
    )


def refit_if_hopeful(
    model: Model,
    split: Split,
    starts: Sequence[Mapping[str, float]],
    before: Refit,
    numerics: Numerics,
    to_beat: Refit,
    least: float = LEAST_DECREASE,
    factors: Sequence[float] = (1.0,),
    tolerance: float = TOLERANCE,
    std_up_to: float = np.inf,
) -> Refit:
    """``refit`` that ends early if it neither takes the share ``least`` from the error of ``to_beat``, fitted
    or held out, nor promises to."""
    cost, loss = ((1 - least) * error for error in (to_beat.cost, to_beat.score.loss))
    return refit(model, split, starts, before, numerics, factors, tolerance, std_up_to, cost, loss)


def refit_beside(
    base: Refit,
    model: Model,
    split: Split,
    starts: Sequence[Mapping[str, float]],
    numerics: Numerics,
    to_beat: Refit,
    least: float,
) -> Refit:
    """``refit_if_hopeful`` of a trial beside ``base``: by every smoothing, with standard errors only where it
    may be judged by them (``judged_up_to``)."""
    std_up_to = judged_up_to(base, least)
    return refit_if_hopeful(
        model, split, starts, base, numerics, to_beat, least, CONTINUATION, std_up_to=std_up_to
    )


def judged_up_to(base: Refit, least: float) -> float:
    """The held-out loss above which a trial beside ``base`` is refused whatever its standard errors are."""
    return (1 - min(least, LEAST_DECREASE)) * base.score.loss


def least_of(worth: float) -> float:
    """The share of the error below which a refit ends early, where a gain of ``worth`` is asked for."""
    return min(LEAST_DECREASE, worth / 2)


def refit_if_possible(
    model: Model,
    split: Split,
    starts: Sequence[Mapping[str, float]],
    before: Refit,
    numerics: Numerics,
    std_up_to: float = WITHOUT_STD,
    hopeful: float = np.inf,
) -> Refit | None:
    """``refit``, or None where the model cannot be simulated with ``numerics``."""
    try:
        return refit(model, split, starts, before, numerics, std_up_to=std_up_to, hopeful=hopeful)
    except (TooStiff, *FAILURES):
        return None


def _descent(
    numerics: Numerics, factors: Sequence[float], tolerance: float, screened: bool, cost_limit: float
) -> Descent:
    """The descent of a refit: of starts that are ``screened`` one is carried on; steps are refined once."""
    handover = Handover(HANDOVERS, Stop(HANDOVER_ITERATIONS, tolerance))
    return Descent(
        handover=handover,
        refinement=Refinement(1, handover, must_hold=False),
        method=numerics.method,
        continuation=tuple(factor * numerics.smoothing for factor in factors),
        stop=Stop(MOST_ITERATIONS, tolerance),
        screening=SCREENING if screened else None,
        cost_limit=cost_limit,
    )


def _standard_errors(fitted: Problem, solution: Solution) -> tuple[dict[str, float], Array]:
    """Standard errors by name and correlations, without the share of the smoothing of sign(v).

    The smoothing moves all parameters together, so its share would hide which of them the records can
    tell apart. Refits at other smoothings show whether a verdict depends on it.
    """
    found = uncertainty(fitted, solution.p, solution.x0)
    moved = found.smoothing
    found = replace(found, covariance=found.covariance - np.outer(moved, moved), smoothing=0.0 * moved)
    return dict(zip(fitted.free, found.std.tolist(), strict=True)), found.correlation
