"""Where the refit of a composed law starts: as near as possible to a learned effort over the same variable.

At each point of a grid of shape parameters, a linear regression along the path gives the amplitudes. The
amplitudes of the model's own terms may change as well, since the learned effort may have taken a part of
their efforts. The point that comes nearest is the start. It only chooses where a refit begins; the refit
decides.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from itertools import product
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from hybridid.declarations import PortKind
from hybridid.effects.composed import EXPONENTS, Bounded, composed
from hybridid.effects.over import MEMORIES, Over
from hybridid.effects.shapes import Role, Shape
from hybridid.trace.horizons.split import Split
from hybridid.trace.ports.path import Path
from hybridid.trace.refits.refitted import Refit

Array = NDArray[np.float64]
SAMPLES = 1000
"""Of the path, along which a shape is held against a learned effort."""
QUANTILES = np.linspace(0.05, 0.95, 10)
"""Of the variable: places where a shape may start."""
WIDTHS = (0.02, 0.05, 0.1, 0.2, 0.4, 0.8)
"""Of the variable's range: widths with which it may start."""
POWERS = (0.5, 0.7, 1.5, 2.0, 3.0, 5.0)
"""Exponents with which it may start."""
BESIDE = (0.05, 0.2, 0.5, 1.5)
"""Of the range: how far outside of it, on either side, a pole may start."""
PERIODS = (0.5, 1.0, 1.5, 2.0, 3.0, 4.0, 6.0)
"""Within the range."""
NARROWEST, WIDEST = 1e-3, 3.0
"""Of the range: bounds of a width or a period, and of how far outside of it a pole lies; a place lies at most
one range outside."""


class _EffortOver(Protocol):
    """An effort (or flow) at ``port`` over one variable: what ``refit`` has there beyond another model."""

    @property
    def port(self) -> str: ...
    @property
    def over(self) -> Over: ...
    @property
    def kind(self) -> PortKind: ...
    @property
    def refit(self) -> Refit: ...


def law_starts(learned: _EffortOver, shape: Shape, base: Refit, split: Split) -> dict[str, Bounded]:
    """Guess and bounds of each parameter of ``shape`` over the variable of ``learned``, beside ``base``."""
    path = Path.of(base, split, split.fitted)
    seen, port = path.seen(learned.port, learned.over), learned.port
    memory = _memory(learned)
    every = slice(None, None, max(1, len(seen) // SAMPLES))
    bare = replace(path, time=path.time[every], states=path.states[every], inputs=path.inputs[every])
    along = replace(bare, states=np.column_stack([bare.states, seen[every]])) if memory else bare
    terms = bare.efforts(base.model, base.values, port)
    own = terms.sum(axis=0)
    target = along.effort(learned.refit.model, learned.refit.values, port) - own
    model = base.model.plus(composed(learned.over, shape, learned.kind), port)
    law = f"{model.terms[-1].name}."
    absent = {**base.values, **{law + name: b.guess for name, b in memory.items()}}

    def with_amplitudes(point: Mapping[str, float]) -> Array:
        """The law with each amplitude at one and the others at zero, (n, amplitudes)."""
        shaped = {**absent, **{law + name: value for name, value in point.items()}}
        zero = {law + name: 0.0 for name in shape.amplitudes}
        columns = [
            along.effort(model, {**shaped, **zero, law + name: 1.0}, port) - own for name in shape.amplitudes
        ]
        return np.column_stack(columns)

    nearest: dict[str, float] = {}
    least = np.inf
    for point in grid(shape, seen):
        columns = with_amplitudes(point)
        columns = np.column_stack([*columns.T, *terms])
        if not np.isfinite(columns).all():
            continue
        share, *_ = np.linalg.lstsq(columns, target, rcond=None)
        error = float(np.sum((target - columns @ share) ** 2))
        if error < least:
            least = error
            nearest = {**point, **dict(zip(shape.amplitudes, share.tolist(), strict=False))}
    return {name: bounded(shape.roles.get(name), value, seen) for name, value in nearest.items()} | memory


def _memory(learned: _EffortOver) -> dict[str, Bounded]:
    """The parameter of a variable with memory, as the learned effort was fitted; none for other variables."""
    memory = MEMORIES.get(learned.over.variable)
    if memory is None:
        return {}
    name = f"{learned.refit.model.terms[-1].name}.{memory.name}"
    declared = next(p for p in learned.refit.model.parameters if p.name == name)
    return {memory.name: Bounded(learned.refit.values[name], declared.lower, declared.upper)}


def grid(shape: Shape, seen: Array) -> Iterator[dict[str, float]]:
    """Every combination of starting values of the shape parameters; a share follows by regression."""
    roles = {name: role for name, role in shape.roles.items() if role != "share"}
    values = [_values(role, seen) for role in roles.values()]
    yield from (dict(zip(roles, point, strict=True)) for point in product(*values))


def _values(role: Role, seen: Array) -> list[float]:
    span = float(np.ptp(seen))
    if role == "place":
        return [float(value) for value in np.quantile(seen, QUANTILES)]
    if role == "pole":
        low, high = float(seen.min()), float(seen.max())
        return [*(high + share * span for share in BESIDE), *(low - share * span for share in BESIDE)]
    if role == "exponent":
        return list(POWERS)
    if role == "reference":
        return [_rounded(float(np.abs(seen).max()))]
    return [share * span for share in WIDTHS] if role == "width" else [span / n for n in PERIODS]


def _rounded(value: float) -> float:
    """``value`` to one digit: a reference is to be read, and the formula is the same by any."""
    return float(f"{value:.0e}") or 1.0


def bounded(role: Role | None, value: float, seen: Array) -> Bounded:
    """A start and its bounds, by the range of what the variable takes in ``seen`` (n,)."""
    span = float(np.ptp(seen))
    if role is None:  # an amplitude
        return Bounded(value, -np.inf, np.inf)
    if role == "exponent":
        return Bounded(value, *EXPONENTS)
    if role == "reference":
        return Bounded(value, value, value)
    if role == "pole":
        low, high = float(seen.min()), float(seen.max())
        if value > high:
            return Bounded(value, high + NARROWEST * span, high + WIDEST * span)
        return Bounded(value, low - WIDEST * span, low - NARROWEST * span)
    if role == "place":
        return Bounded(value, float(seen.min()) - span, float(seen.max()) + span)
    return Bounded(value, NARROWEST * span, WIDEST * span)
