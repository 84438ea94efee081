"""Where a refit begins: the steps of each start, and the initial states that a poorer model lends."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from hybridid.estimators.carried import carry
from hybridid.estimators.plan import Start
from hybridid.estimators.problem import Problem, paths
from hybridid.estimators.start import at_rest, best_initial_states, x0_candidates
from hybridid.model import Model
from hybridid.simulation.initial import observed
from hybridid.simulation.stability import IMPLICIT, LIMIT, MOST, STABLE, TooStiff
from hybridid.trace.horizons.split import Split
from hybridid.trace.refits.numerics import Numerics
from hybridid.trace.refits.refitted import Refit

Array = NDArray[np.float64]
STIFF = 8
"""Steps a sample that are many for one more effect: see ``room_beside``."""


def starts_of(
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
    if min(wanted) > most_steps(before):
        raise TooStiff(f"needs more than {most_steps(before)} steps a sample at every start")
    limit = max(room_beside(before), min(wanted))
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


def problem_of(model: Model, split: Split, before: Refit, values: Mapping[str, float]) -> Problem:
    """Every horizon of ``split`` as a problem of ``model``, solved as ``before`` was, in steps fit for
    ``values``. The implicit integrator is stable in the steps that ``before`` took, where ``MOST`` do not
    resolve it.

    Raises:
        TooStiff: if RK4 needs more than ``most_steps``.
    """
    steps = before.numerics.steps(model, model.values(values), split, _lent(before, model, split))
    if steps > MOST and before.numerics.integrator == IMPLICIT:
        steps = before.steps
    if steps > most_steps(before):
        raise TooStiff(f"needs more than {most_steps(before)} steps a sample")
    return before.numerics.problem(model, split, steps)


def _lent(before: Refit, model: Model, split: Split) -> list[Array]:
    """The paths of ``before`` as states of ``model``; a state that ``before`` lacks is zero."""
    names = [state.name for state in before.model.states]
    begun = paths(before.problem(split), before.model.values(before.values), before.x0)
    known = {k: names.index(s.name) for k, s in enumerate(model.states) if s.name in names}
    lent = [np.zeros((len(path), len(model.states))) for path in begun]
    for own, path in zip(lent, begun, strict=True):
        own[:, list(known)] = path[:, list(known.values())]
    return lent


def room_beside(before: Refit | None) -> int:
    """Steps a sample up to which a refit is solved as the poorer model ``before`` was: half as many again as
    that takes, and ``STIFF`` at least. What needs more is stiff by the effect that it adds."""
    taken = 0 if before is None else before.steps
    return max(STIFF, taken + taken // 2)


def is_too_stiff(wanted: int, before: Refit | None, numerics: Numerics) -> bool:
    """Whether a refit beside ``before`` that ends where ``wanted`` steps a sample are called for is too stiff
    for those of ``room_beside``. Of RK4 more are called for than it needs to be stable. Where it is stable, a
    second descent by the implicit integrator would give the little accuracy that is lost near rest."""
    margin = 1.0 if numerics.integrator == IMPLICIT else LIMIT / STABLE
    return wanted > margin * room_beside(before)


def most_steps(before: Refit | None) -> int:
    """Steps a sample above which nothing is solved: ``MOST``, or what an effect beside ``before`` gets."""
    return max(MOST, room_beside(before))
