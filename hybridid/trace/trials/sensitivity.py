"""What the outputs would show of a small effect, less all that the model could do instead.

The derivative of the outputs by an effect's amplitude, at amplitude zero, is one column for each amplitude.
The initial state of each horizon and the parameters of the model can make a part of it, so that part is
projected out. What is left of several effects' columns says how much of the residual they would take
together, to first order (Frisch, Waugh (1933), Econometrica 1(4), 387-401). An effect that is strong where
it acts (an edge that a level cannot pass) is far from its derivative at zero. So the change of the outputs
that its trial alone made is a shape as well. An effect with neither (a limit that nothing reaches) shows the
change at each amplitude that it may start with.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from hybridid.estimators.carried import by_parameter
from hybridid.estimators.jacobian import columns
from hybridid.estimators.problem import Problem
from hybridid.model import Model
from hybridid.trace.candidates import Candidate, each_once
from hybridid.trace.horizons.split import Split
from hybridid.trace.refits.refit import FAILURES
from hybridid.trace.refits.refit_starts import begin, problem_of
from hybridid.trace.refits.refitted import Refit
from hybridid.trace.starts.sought import known_means, sought
from hybridid.trace.trials.trial import Trial

Array = NDArray[np.float64]
_Projected = tuple["Shape", Array] | None
T = TypeVar("T")
SAMPLES = 10000
"""Of the outputs, evenly chosen, that decide at most."""
UNSEEN = 1e-6
"""Share of a column, left by the projection, that is rounding alone."""


@dataclass(frozen=True, eq=False)
class Shape:
    """One shape of an effect: its ``columns`` (n, k), one for each amplitude, less what the base model could
    do instead.

    ``positive`` (k,): which amplitudes cannot be negative. ``start`` holds the effect's own parameters by
    qualified name: the amplitudes are zero or, where the columns are differences, those that made them.
    """

    columns: Array
    positive: tuple[bool, ...]
    start: Mapping[str, float]


@dataclass(frozen=True, eq=False)
class Seen:
    """A candidate with its shapes; none where its sensitivities cannot be had. ``residual`` (n,) is that of
    the base model, less what this could do instead."""

    candidate: Candidate
    shapes: tuple[Shape, ...] = ()
    residual: Array = field(default_factory=lambda: np.empty(0))


@np.errstate(all="ignore")  # a start may diverge: it has no shape
def seen(
    candidate: Candidate, single: Trial | None, base: Refit, split: Split, searched: bool = False
) -> Seen:
    """The shapes of ``candidate`` beside ``base``: those that it starts with, and the one with which its
    trial ``single`` ended. ``searched``: also those with the pitches and the like that its trial would find
    in the records."""
    found = list(_shapes(candidate, single, base, split, searched))
    return Seen(candidate, tuple(shape for shape, _ in found), found[0][1]) if found else Seen(candidate)


def _shapes(
    candidate: Candidate, single: Trial | None, base: Refit, split: Split, searched: bool
) -> Iterator[tuple[Shape, Array]]:
    """Shapes with derivatives, each with the residual, and the change that the trial ``single`` made; only if
    there are none of either, with differences."""
    model = candidate.added_to(base.model)
    port, known = model.plant.port(candidate.port), known_means(candidate, model, split)
    amplitudes = {f"{candidate.name}.{p.name}": p.at(port) for p in candidate.effect.parameters if p.nests}
    nothing = dict.fromkeys(amplitudes, 0.0)
    begun: list[Mapping[str, float]] = [*candidate.starts(model, base.values)]
    if searched:
        begun += _if_possible(sought, candidate, model, base, split) or ()
    if single is not None and single.refit is not None:
        begun = [single.refit.values, *begun]
    starts = [{**base.values, **_own(start, candidate), **known} for start in begun]
    positive = tuple(p.lower >= 0 for p in amplitudes.values())
    view = _View(candidate, model, base, split, positive)
    absent = each_once([{**start, **nothing} for start in starts])
    found = [_if_possible(view.derivative, start, tuple(amplitudes)) for start in absent]
    if single is not None and single.refit is not None:
        found.append(_if_possible(view.ended, single.refit, absent[0]))
    if not any(found):
        present = each_once([start for start in starts if any(start[name] for name in amplitudes)])
        found = [_if_possible(view.difference, start, {**start, **nothing}) for start in present]
    yield from filter(None, found)


def _own(start: Mapping[str, float], candidate: Candidate) -> dict[str, float]:
    """The effect's own values: beside them, all others stay where the base model ended."""
    return {name: value for name, value in start.items() if name.startswith(f"{candidate.name}.")}


def _if_possible(look: Callable[..., T], *given: object) -> T | None:
    """What ``look`` gives; None where the model cannot be simulated from there."""
    try:
        return look(*given)
    except (ValueError, *FAILURES):
        return None


@dataclass(frozen=True, eq=False)
class _Point:
    """Where a look begins: the problem on the fitted horizons, parameters and initial states, and there J
    (w, n_x + n_free, n) and the residuals (w, n)."""

    problem: Problem
    p: Array
    x0: Array
    by: Array
    error: Array


@dataclass(frozen=True, eq=False)
class _View:
    """Looks at a candidate beside ``base``, in ``model``, on the fitted horizons."""

    candidate: Candidate
    model: Model
    base: Refit
    split: Split
    positive: tuple[bool, ...]
    points: dict[tuple[tuple[str, float], ...], _Point] = field(default_factory=dict)
    """Those that were looked from, by their starts."""

    def derivative(self, start: Mapping[str, float], amplitudes: Sequence[str]) -> _Projected:
        """The derivatives by the ``amplitudes`` at zero."""
        at = self._at(start)
        problem, by, error = at.problem, at.by, at.error
        own = [problem.free.index(name) for name in amplitudes if name in problem.free]
        if len(own) < len(amplitudes):
            return None
        return self._shape(problem, by, np.take(by, [len(at.x0[0]) + k for k in own], axis=1), error, start)

    def difference(self, start: Mapping[str, float], absent: Mapping[str, float]) -> _Projected:
        """The change of the outputs from ``absent`` to ``start``."""
        at = self._at(absent)
        there = at.problem.smoothed(self.model.values(start), self.base.numerics.smoothing)
        change = at.error - _residuals(at.problem, there, at.x0)
        return self._shape(at.problem, at.by, change[:, None], at.error, start, several=False)

    def ended(self, single: Refit, absent: Mapping[str, float]) -> _Projected:
        """The change of the outputs from ``absent`` to where a trial ended, all that it moved included."""
        at, fitted = self._at(absent), list(self.split.fitted)
        there = replace(single, model=self.model).problem(self.split).on(fitted)
        change = at.error - _residuals(there, self.model.values(single.values), single.x0[fitted])
        return self._shape(at.problem, at.by, change[:, None], at.error, single.values, several=False)

    def _at(self, start: Mapping[str, float]) -> _Point:
        """The point of ``start``; each is simulated once."""
        key = tuple(sorted(start.items()))
        if key not in self.points:
            fitted = list(self.split.fitted)
            problem = problem_of(self.model, self.split, self.base, start)
            begun = begin(problem, self.model.values(start), self.base, self.base.numerics)
            problem, x0 = problem.on(fitted), begun.x0[fitted]
            self.points[key] = _Point(problem, begun.p, x0, *linearised(problem, begun.p, x0))
        return self.points[key]

    def _shape(
        self,
        problem: Problem,
        by: Array,
        own: Array,
        error: Array,
        start: Mapping[str, float],
        several: bool = True,
    ) -> _Projected:
        """``own`` (w, k, n) and ``error`` (w, n), less what the other columns of ``by`` (w, q, n) can do."""
        known = {p.name for p in self.base.model.free}
        kept = [len(problem.model.states) + k for k, name in enumerate(problem.free) if name in known]
        states = by[:, : len(problem.model.states)] * problem.moving[:, :, None]
        given = np.concatenate([by[:, kept], own, error[:, None]], axis=1)
        if not np.isfinite(given).all() or not np.isfinite(states).all():
            return None
        size = np.linalg.norm(own, axis=(0, 2))
        left = without(given, states)
        flat = left.swapaxes(0, 1).reshape(left.shape[1], -1).T
        rest = _orthogonal(flat[:, len(kept) :], flat[:, : len(kept)])
        if not (np.linalg.norm(rest[:, :-1], axis=0) > UNSEEN * size).all():
            return None
        every = slice(None, None, -(-len(rest) // SAMPLES))
        positive = self.positive if several else (True,)
        return Shape(rest[every, :-1], positive, _own(start, self.candidate)), rest[every, -1]


def linearised(problem: Problem, p: Array, x0: Array) -> tuple[Array, Array]:
    """J (w, n_x + n_free, n) and the residuals (w, n) at a point."""
    shot = problem.shooter(x0, p, sensitivities=True)
    by = columns(problem, shot.by_state, by_parameter(problem, shot))
    return by, problem.residuals(shot).swapaxes(1, 2).reshape(len(by), -1)


def _residuals(problem: Problem, p: Array, x0: Array) -> Array:
    """The residuals (w, n) at a point."""
    return problem.residuals(problem.shooter(x0, p)).swapaxes(1, 2).reshape(len(x0), -1)


def without(given: Array, states: Array) -> Array:
    """Each horizon's rows ``given`` (w, q, n) less their projection on its rows ``states`` (w, m, n)."""
    if not states.shape[1]:
        return given
    sizes = np.linalg.norm(states, axis=2, keepdims=True)
    u, s, _ = np.linalg.svd((states / np.where(sizes > 0, sizes, 1.0)).swapaxes(1, 2), full_matrices=False)
    u = np.where(s[:, None] > UNSEEN * s[:, None, :1], u, 0.0)
    return given - (given @ u) @ u.swapaxes(1, 2)


def _orthogonal(given: Array, others: Array) -> Array:
    """The columns ``given`` (n, k) less their projection on the columns ``others`` (n, m)."""
    return without(given.T[None], others.T[None])[0].T
