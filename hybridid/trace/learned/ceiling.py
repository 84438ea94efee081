"""The ceiling: how much any effect at a port could explain that depends on one variable.

A learned effort (``hybridid.trace.learned.learned_effort``) is fitted in simulation, like any effect,
together with every other parameter. No effect of that variable alone can gain more than that on held-out
horizons, up to the grid's resolution.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from hybridid.declarations import Port, PortKind
from hybridid.effects.over import MEMORIES, Over
from hybridid.model import Model
from hybridid.simulation.stability import TooStiff
from hybridid.trace.context import Context
from hybridid.trace.horizons.evidence import compare, holm
from hybridid.trace.horizons.split import Split
from hybridid.trace.learned.learned_effort import is_learned, with_learned_effort
from hybridid.trace.learned.promising_efforts import Place, promising
from hybridid.trace.ports.path import Path
from hybridid.trace.refits.numerics import Numerics
from hybridid.trace.refits.refit import FAILURES, LEAST_DECREASE, WITHOUT_STD, least_of, refit_if_hopeful
from hybridid.trace.refits.refitted import Refit
from hybridid.trace.rules import Rules
from hybridid.trace.starts.shorter import learned_from_shorter
from hybridid.trace.starts.solve import Solved, by_either_integrator

Array = NDArray[np.float64]
TOLERANCE = 1e-4
"""Of the fits: the gain of a learned effort is needed to a few digits only."""
MARGIN = 0.1
"""Of the fitted range: a learned effort is known up to there, by its widths."""
LEAST_WITHIN = 5
"""Held-out horizons within the fitted range, from which its share there can be told."""
BINS, LEAST_IN_BIN = 60, 20
"""Of the curve that is shown."""


@dataclass(frozen=True)
class Ceiling:
    """Held-out ``gain`` of a learned effort (or flow) at ``port`` over ``over``, with its p-value.

    ``p_value`` is adjusted for all that were fitted beside the same model (Holm), ``p_alone`` is not.
    ``curve`` (s, effort, samples) is the learned effort in ``unit``, divided by its factor, over s in
    ``over_unit``, plus the change of the model's own terms in the refit: alone, bumps and viscous friction
    could trade any amount.
    ``refit`` is the model with it. If it could not be solved, ``failure`` says why. There is then no curve,
    and neither the gain of zero nor ``refit``, the model without it, claims anything.

    ``beyond``: on some held-out horizons the variable leaves the range of the fitted ones, where nothing has
    been learned. ``within`` is the share of the squared error that it takes from the other ones, or from the
    fitted ones where fewer than ``LEAST_WITHIN`` are left.
    """

    port: str
    over: Over
    gain: float
    p_value: float
    curve: tuple[tuple[float, float, int], ...]
    unit: str
    over_unit: str
    refit: Refit
    failure: str = ""
    beyond: bool = False
    within: float = 0.0
    p_alone: float = 1.0

    @property
    def place(self) -> str:
        """``carriage over position, times velocity``."""
        return f"{self.port} over {self.over}"

    @property
    def kind(self) -> PortKind:
        """Of the port: whether an effort or a flow was learned."""
        return self.refit.model.plant.port(self.port).kind

    @property
    def fitted(self) -> bool:
        """Whether ``refit`` holds the learned effort: it was solved, and promised enough to be fitted."""
        return any(is_learned(term.effect) for term in self.refit.model.terms)

    @property
    def described(self) -> str:
        """``a learned effort at carriage over position, times velocity``."""
        return f"a learned {self.kind} at {self.place}"

    def passes(self, rules: Rules) -> bool:
        """Whether the learned effort's gain is worth having and significant."""
        return rules.passes(self.gain, self.p_value)

    def untested(self, rules: Rules) -> bool:
        """Whether it takes nearly all of the squared error within the range where it is fitted, and its
        variable leaves that. There a law goes on; the learned effort stays as it is at the end."""
        return self.beyond and self.within >= 1 - rules.stands_in

    def taken(self, base: Refit) -> float:
        """What it takes from the held-out squared error of ``base``."""
        return base.score.loss**2 - self.refit.score.loss**2

    def most(self, base: Refit, rules: Rules) -> float:
        """What a law of this variable could take from the held-out squared error of ``base``: what the
        learned effort takes, or where that is untested as large a share as it takes within its range."""
        within = self.within * base.score.loss**2 if self.untested(rules) else 0.0
        return max(self.taken(base), within)


def ceilings(
    base: Refit, context: Context, stage: str = "learned effort", promised: float | None = None
) -> tuple[Ceiling, ...]:
    """The ceiling of every variable at every effort or flow port where the path of ``base`` shows it. Those
    that promise less than this share of the fitted cost are not fitted (``promising_efforts``), and count as
    ended early."""
    path = Path.of(base, context.split, context.split.fitted)
    shown = [
        (port.name, over)
        for port in context.equation_ports(base.model)
        for over in context.overs(port, base.model)
        if path.shows(port.name, over)
    ]
    chosen = shown if promised is None else promising(shown, base, context, promised)
    return ceilings_at(shown, chosen, base, context, stage)


def ceilings_at(
    places: Sequence[Place], chosen: Sequence[Place], base: Refit, context: Context, stage: str
) -> tuple[Ceiling, ...]:
    """The ceilings at ``places`` (port and variable) beside ``base``, of which the ``chosen`` are fitted."""
    least = least_of(context.rules.worth)
    found = context.each(
        stage,
        ceiling,
        [(base, context.split, *place, least) for place in chosen],
        lambda found: found.place,
        lambda _base, _split, _port, over, _least: over.variable in MEMORIES,
    )
    fitted = {(one.port, one.over): one for one in found}
    every = [fitted.get(place) or _not_fitted(base, *place) for place in places]
    adjusted = holm([one.p_alone for one in every])
    return tuple(replace(one, p_value=p) for one, p in zip(every, adjusted, strict=True))


def _not_fitted(base: Refit, port: str, over: Over) -> Ceiling:
    """Of a learned effort that promises little beside ``base``."""
    where, ended = base.model.plant.port(port), replace(base, ended_early=True)
    return Ceiling(port, over, 0.0, 1.0, (), *_units(where, over), ended)


def _units(where: Port, over: Over) -> tuple[str, str]:
    """Of what the factor multiplies, and of the variable."""
    return over.amplitude.unit(where), over.dimension.unit(where)


def ceiling(base: Refit, split: Split, port: str, over: Over, least: float = LEAST_DECREASE) -> Ceiling:
    """Fit a learned effort (or flow) at ``port`` together with every parameter and score it held out.

    The fit ends early where it takes less than ``least``, as in ``refit_if_hopeful``.
    """
    where = base.model.plant.port(port)
    path = Path.of(base, split, (*split.fitted, *split.held_out))
    fitted = Path.of(base, split, split.fitted)
    model, starts = with_learned_effort(base, fitted, port, over)
    units = _units(where, over)
    solved = _solved(model, split, starts, base, least)
    found = solved.refit
    if found is None:
        return Ceiling(port, over, 0.0, 1.0, (), *units, base, failure=solved.failure)
    evidence = compare(base.score, found.score)
    shown = (
        replace(path, states=np.column_stack([path.states, path.seen(port, over)]))
        if model.terms[-1].effect.states
        else path
    )
    net = shown.effort(model, found.values, port) - path.effort(base.model, base.values, port)
    curve = _binned(path.seen(port, over), net, path.factor(port, over))
    inside = _inside(base, split, port, over, fitted.seen(port, over))
    return Ceiling(
        port,
        over,
        evidence.gain,
        evidence.p_value,
        curve,
        *units,
        found,
        beyond=not inside.all(),
        within=_taken_within(base, found, inside),
        p_alone=evidence.p_value,
    )


def _solved(
    model: Model, split: Split, starts: Sequence[Mapping[str, float]], base: Refit, least: float
) -> Solved:
    """The ``model`` with the learned effort, by either integrator."""

    def solve(numerics: Numerics, to_beat: Refit, chosen: Sequence[int] | None) -> Solved:
        own = starts if chosen is None else [starts[k] for k in chosen]
        given = (model, split, own, base, numerics, to_beat, least)
        try:
            return Solved(refit_if_hopeful(*given, tolerance=TOLERANCE, std_up_to=WITHOUT_STD))
        except (TooStiff, *FAILURES) as error:
            return Solved(None, str(error))

    return _unless_lower_from_shorter(by_either_integrator(solve, base), model, starts, base, split, least)


def _unless_lower_from_shorter(
    solved: Solved,
    model: Model,
    starts: Sequence[Mapping[str, float]],
    base: Refit,
    split: Split,
    least: float,
) -> Solved:
    """``solved``, or the fit from where shorter horizons end, if there is one and it is lower."""
    found = learned_from_shorter(model, starts, base, split)
    if found is None:
        return solved
    lowest, (start, begun) = min(filter(None, (solved.refit, base)), key=lambda one: one.cost), found
    given = (model, split, [start], begun, base.numerics, lowest, least)
    try:
        again = refit_if_hopeful(*given, tolerance=TOLERANCE, std_up_to=WITHOUT_STD)
    except (TooStiff, *FAILURES):
        return solved
    return solved if again.ended_early or again.cost >= lowest.cost else Solved(again)


def _inside(base: Refit, split: Split, port: str, over: Over, fitted: Array) -> NDArray[np.bool_]:
    """On which held-out horizons (h,) the variable stays in the range of its ``fitted`` values (m,)."""
    seen = Path.of(base, split, split.held_out).seen(port, over)
    used = base.problem(split).on(split.held_out).windows.used
    ends = np.cumsum(used.sum(axis=1))[:-1]
    margin = MARGIN * np.ptp(fitted)
    low, high = fitted.min() - margin, fitted.max() + margin
    return np.array([low <= one.min() and one.max() <= high for one in np.split(seen, ends)])


def _taken_within(base: Refit, found: Refit, inside: NDArray[np.bool_]) -> float:
    """The share that ``found`` takes from the squared error of ``base`` on the held-out horizons ``inside``,
    or on the fitted ones where these are too few."""
    if inside.sum() < LEAST_WITHIN:
        return 1.0 - found.cost / base.cost if base.cost > 0 else 0.0
    before, after = (float((one.score.squares[inside] / one.score.scale**2).sum()) for one in (base, found))
    return 1.0 - after / before if before > 0 else 0.0


def _binned(s: Array, effort: Array, factor: Array) -> tuple[tuple[float, float, int], ...]:
    """What ``effort`` is over ``factor``, by least squares in bins of ``s`` that hold samples enough, as (s,
    effort, samples)."""
    edges = np.linspace(s.min(), s.max(), BINS + 1)
    bins = np.clip(np.digitize(s, edges) - 1, 0, BINS - 1)
    members = [bins == k for k in range(BINS)]
    return tuple(
        (float(s[m].mean()), float(effort[m] @ factor[m] / (factor[m] @ factor[m])), int(m.sum()))
        for m in members
        if m.sum() >= LEAST_IN_BIN and factor[m].any()
    )


def strongest(found: Sequence[Ceiling]) -> Ceiling:
    """The one with the largest gain, of those that were fitted."""
    return max(found, key=lambda one: (one.fitted, one.gain))
