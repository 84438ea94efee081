"""Solves a refit by the integrator of its base model, or by the implicit one where needed and better."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Protocol, TypeVar, cast

from hybridid.estimators.problem import paths
from hybridid.model import Model
from hybridid.simulation.stability import MOST, TooStiff
from hybridid.trace.context import Context
from hybridid.trace.horizons.split import Split
from hybridid.trace.refits.numerics import Numerics
from hybridid.trace.refits.refit import CONTINUATION, FAILURES, LEAST_DECREASE, refit
from hybridid.trace.refits.refitted import Refit

OTHERWISE = "rodas3"
"""The implicit integrator: it takes up a trial that RK4 could not solve."""


class Attempted(Protocol):
    """What a trial came to: a ``refit``, or the ``failure`` in words."""

    @property
    def refit(self) -> Refit | None:
        """The refitted model; None if it could not be fitted."""

    @property
    def failure(self) -> str:
        """Why it could not be fitted."""


@dataclass(frozen=True)
class Solved:
    """A refit, or why none could be made."""

    refit: Refit | None
    failure: str = ""


T = TypeVar("T", bound=Attempted)
Solve = Callable[[Numerics, Refit, Sequence[int] | None], T]
"""``solve(numerics, to_beat, chosen)``: a trial from all starts, or from the ``chosen`` ones by number, that
may end early where it does not beat a refit."""


def by_either_integrator(solve: Solve[T], base: Refit) -> T:
    """The trial by the integrator of ``base``, or by the implicit one where that is needed and better.

    The implicit one takes the starts that the other could not solve, or all if the end is too stiff. It
    counts if it explains more: else everything that follows would be solved the slow way for nothing.
    """
    trial = solve(base.numerics, base, None)
    end_solved = trial.refit is not None and not trial.refit.too_stiff
    unsolved = trial.refit.unsolved if trial.refit and end_solved else None
    if base.numerics.integrator == OTHERWISE or unsolved == ():
        return trial
    to_beat = trial.refit if trial.refit and trial.refit.cost < base.cost else base
    again = solve(replace(base.numerics, integrator=OTHERWISE), to_beat, unsolved)
    if trial.refit is None and again.refit is None:
        failure = f"{trial.failure}; with {OTHERWISE}: {again.failure}"
        return cast("T", replace(cast("Any", again), failure=failure))
    return again if _explains_more(again, trial) else trial


def _explains_more(one: Attempted, other: Attempted) -> bool:
    """Whether ``one`` could be fitted and the other could not, or its error is lower, fitted or held out."""
    if one.refit is None or other.refit is None:
        return one.refit is not None
    lower = one.refit.cost < (1 - LEAST_DECREASE) * other.refit.cost
    return lower or one.refit.score.loss < (1 - LEAST_DECREASE) * other.refit.score.loss


def refit_declared(
    model: Model, split: Split, starts: Sequence[Mapping[str, float]], numerics: Numerics
) -> Refit:
    """The declared model, refitted from the best of ``starts`` (values by name).

    Beside it everything else is solved as it was. If its end is too stiff for RK4, it is refitted with the
    implicit integrator, from there as well. That counts if it is not too stiff there too, or explains more.

    Raises:
        TooStiff: if the model is, at every start.
    """
    found = refit(model, split, starts, None, numerics, CONTINUATION)
    if numerics.integrator == OTHERWISE or not _too_stiff(found, split):
        return found
    implicit = replace(numerics, integrator=OTHERWISE)
    try:
        again = refit(model, split, [found.values, *starts], None, implicit, CONTINUATION)
    except (TooStiff, *FAILURES):
        return found
    better = not _too_stiff(again, split) or _explains_more(Solved(again), Solved(found))
    return again if better else found


def declared_refit(
    model: Model, context: Context, starts: Sequence[Mapping[str, float]], numerics: Numerics
) -> Refit:
    """``refit_declared`` on the horizons of ``context``: a trace asks for the same refit several times, and
    makes it once."""
    key = (id(model), numerics, tuple(tuple(one.items()) for one in starts))
    if key not in context.declared:
        context.declared[key] = context.one(refit_declared, model, context.split, starts, numerics)
    return context.declared[key]


def _too_stiff(found: Refit, split: Split) -> bool:
    """Whether no number of steps a sample resolves the model where its refit ended."""
    problem, p = found.problem(split), found.model.values(found.values)
    return found.numerics.steps(found.model, p, split, paths(problem, p, found.x0)) > MOST
