"""Refit a model on the fitted horizons and score it on the held-out ones.

All parameters are refitted together: an effect that is left out biases every one of them, so a
candidate tried with the others frozen would be judged by the wrong model.
"""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from hybridid.estimators.carried import carry
from hybridid.estimators.descent import descend, go_on, refine
from hybridid.estimators.estimate import Solution
from hybridid.estimators.plan import Descent, Handover, Refinement, Result, Start
from hybridid.estimators.problem import Problem, paths
from hybridid.estimators.start import at_rest, best_initial_states, x0_candidates
from hybridid.estimators.stop import Stop
from hybridid.estimators.uncertainty import uncertainty
from hybridid.model import Model
from hybridid.simulation.initial import observed
from hybridid.simulation.simulate import Diverged
from hybridid.simulation.stability import IMPLICIT, MOST, TooStiff
from hybridid.trace.numerics import DECLARED, Numerics
from hybridid.trace.score import Score
from hybridid.trace.scored import scored
from hybridid.trace.split import Split

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
STIFF = 8
"""Steps a sample that are many for one more effect: see ``_room``."""
FAILURES = (Diverged, ArithmeticError, np.linalg.LinAlgError)
"""Other errors of a model that cannot be simulated."""


@dataclass(frozen=True)
class Refit:
    """A model fitted on the split's fitted horizons, and its score on the held-out ones.

    ``x0`` (w, n_x) are the initial states of all horizons, fitted and held out; ``numerics`` say how its
    equations were solved, in ``substeps`` a sample. ``std`` and ``correlation`` are those of the noise alone,
    empty where they were not asked for.

    ``unsolved`` are the numbers of the starts that were left out as too stiff, or that diverged with a new
    inner state, whose stiffness no path of the poorer model shows. It is ``too_stiff`` if the end would need
    more steps than there is room for (``_room``). In either case the integrator may have decided, not the
    records. It ``ended_early`` if no start was hopeful. ``shorter``: over shorter horizons, if that differs.
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
    substeps: int
    numerics: Numerics = DECLARED
    unsolved: tuple[int, ...] = ()
    too_stiff: bool = False
    ended_early: bool = False
    shorter: Refit | None = None

    def problem(self, split: Split) -> Problem:
        """Every horizon of ``split`` as the problem that was solved."""
        return self.numerics.problem(self.model, split, self.substeps // self.numerics.finer)


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

    room = _room(before)
    remembers = before is not None and len(model.states) > len(before.model.states)
    begun = _starts(model, split, starts, before, numerics)
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
        too_stiff=wanted > room,
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


def values_without(refitted: Refit, name: str) -> dict[str, float]:
    """The parameter values of ``refitted`` without those of the effect ``name``."""
    kept = {p.name for p in refitted.model.without(name).parameters}
    return {key: value for key, value in refitted.values.items() if key in kept}


def problem_of(model: Model, split: Split, before: Refit, values: Mapping[str, float]) -> Problem:
    """Every horizon of ``split`` as a problem of ``model``, solved as ``before`` was, in steps fit for
    ``values``. The implicit integrator is stable in the steps that ``before`` took, where ``MOST`` do not
    resolve it.

    Raises:
        TooStiff: if RK4 needs more than ``_most``.
    """
    steps = before.numerics.steps(model, model.values(values), split, _lent(before, model, split))
    if steps > MOST and before.numerics.integrator == IMPLICIT:
        steps = before.substeps // before.numerics.finer
    if steps > _most(before):
        raise TooStiff(f"needs more than {_most(before)} steps a sample")
    return before.numerics.problem(model, split, steps)


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


def _lent(before: Refit, model: Model, split: Split) -> list[Array]:
    """The paths of ``before`` as states of ``model``; a state that ``before`` lacks is zero."""
    names = [state.name for state in before.model.states]
    begun = paths(before.problem(split), before.model.values(before.values), before.x0)
    known = {k: names.index(s.name) for k, s in enumerate(model.states) if s.name in names}
    lent = [np.zeros((len(path), len(model.states))) for path in begun]
    for own, path in zip(lent, begun, strict=True):
        own[:, list(known)] = path[:, list(known.values())]
    return lent


def _room(before: Refit | None) -> int:
    """Steps a sample up to which a refit is solved as the poorer model ``before`` was: half as many again as
    that takes, and ``STIFF`` at least. What needs more is stiff by the effect that it adds."""
    taken = 0 if before is None else before.substeps // before.numerics.finer
    return max(STIFF, taken + taken // 2)


def _most(before: Refit | None) -> int:
    """Steps a sample above which nothing is solved: ``MOST``, or what an effect beside ``before`` gets."""
    return max(MOST, _room(before))


def _starts(
    model: Model,
    split: Split,
    starts: Sequence[Mapping[str, float]],
    before: Refit | None,
    numerics: Numerics,
) -> dict[int, Start]:
    """The starts that are not too stiff by their numbers, each in steps of its own.

    The implicit integrator is stable in any number of steps. Where ``MOST`` do not resolve a start, it begins
    with ``STIFF``, which is what the end gets at most.

    Raises:
        TooStiff: if every start is.
    """
    about = None if before is None else _lent(before, model, split)
    wanted = [numerics.steps(model, model.values(s), split, about) for s in starts]
    if numerics.integrator == IMPLICIT:
        wanted = [steps if steps <= MOST else STIFF for steps in wanted]
    if min(wanted) > _most(before):
        raise TooStiff(f"needs more than {_most(before)} steps a sample at every start")
    limit = max(_room(before), min(wanted))
    problems = {n: numerics.problem(model, split, n) for n in sorted(set(wanted)) if n <= limit}
    return {
        k: begin(problems[steps], model.values(start), before, numerics)
        for k, (start, steps) in enumerate(zip(starts, wanted, strict=True))
        if steps <= limit
    }


def begin(problem: Problem, values: Array, before: Refit | None, numerics: Numerics) -> Start:
    """A start with the initial states of the poorer model, or without one the best at hand. A horizon that is
    trapped there begins again with those that the record shows, or at rest."""
    p = problem.smoothed(values, numerics.smoothing)
    x0 = problem.measured_x0()
    if before is None:
        x0 = best_initial_states(problem, p, [x0, *x0_candidates(problem, p)])
    else:
        names = [s.name for s in problem.model.states]
        for column, state in enumerate(before.model.states):
            if state.name in names:
                x0[:, names.index(state.name)] = before.x0[:, column]
    x0, shown, measured = carry(problem, p, x0), observed(problem.model), problem.measured_x0()
    candidates = (np.where(shown, one, x0) for one in (measured, at_rest(problem, measured)))
    return Start(problem, p, x0, tuple(candidates))


def begun_at_the_record(base: Refit, values: Mapping[str, float], split: Split) -> Refit:
    """``base`` with the initial states that the record shows, or the best at hand, for its model at
    ``values``: where it lends these, a refit does not begin where ``base`` ended."""
    begun = begin(base.problem(split), base.model.values(values), None, base.numerics)
    return replace(base, x0=begun.x0)


def _standard_errors(fitted: Problem, solution: Solution) -> tuple[dict[str, float], Array]:
    """Standard errors by name and correlations, without the share of the smoothing of sign(v).

    The smoothing moves all parameters together, so its share would hide which of them the records can
    tell apart. Refits at other smoothings show whether a verdict depends on it.
    """
    found = uncertainty(fitted, solution.p, solution.x0)
    moved = found.smoothing
    found = replace(found, covariance=found.covariance - np.outer(moved, moved), smoothing=0.0 * moved)
    return dict(zip(fitted.free, found.std.tolist(), strict=True)), found.correlation
