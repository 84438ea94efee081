"""What may be wrong with a record or a model beside missing physics, each as a change that would correct it.

A channel whose sign is reversed, that is in another unit than declared, or two columns that are swapped: the
record is changed back. A parameter that wants to leave its bounds: they are released.

A signal that preprocessing made of a recorded one is no column of the file. It has no sign and no unit of its
own, and is swapped with nothing: a mistake in the recorded one is a mistake in both.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import combinations
from typing import Literal

import numpy as np

from hybridid.model import Model
from hybridid.records.record import Array, Channel, Record

Kind = Literal["sign", "unit", "swapped", "bound"]
DEGREES, RPM, GRAVITY = 180.0 / math.pi, 30.0 / math.pi, 9.80665
SAMPLED = 0.5
"""A column that changes less often than this share of what an output does is a switch or a set point, and no
output that was taken for an input."""


@dataclass(frozen=True)
class Hypothesis:
    """What is supposed, ``said`` in words. Columns are those of the ``inputs`` and of the outputs side by
    side: each is multiplied by its entry of ``factors``, then taken from ``order``. ``released`` names
    parameters whose bounds are left out."""

    kind: Kind
    said: str
    factors: tuple[float, ...]
    order: tuple[int, ...]
    inputs: int
    released: tuple[str, ...] = ()

    @property
    def other_outputs(self) -> bool:
        """Whether an input takes the place of an output."""
        return min(self.order[self.inputs :]) < self.inputs

    @property
    def by_input(self) -> Array:
        """The factor of each input, (n_u,)."""
        return np.array(self.factors[: self.inputs])

    @property
    def by_output(self) -> Array:
        """The factor of each output, (n_y,)."""
        return np.array(self.factors[self.inputs :])

    def concerns(self, channels: Collection[int]) -> bool:
        """Whether it changes one of the ``channels``, by number, or no channel at all."""
        touched = {k for k, factor in enumerate(self.factors) if factor != 1.0}
        touched |= {k for k, place in enumerate(self.order) if place != k}
        return not touched or not touched.isdisjoint(channels)

    def applied(self, record: Record) -> Record:
        """``record`` with the change undone that is supposed."""
        both = np.column_stack([record.inputs, record.outputs]) * np.array(self.factors)
        both, n_u = both[:, list(self.order)], record.inputs.shape[1]
        changed = {"inputs": both[:, :n_u], "outputs": both[:, n_u:], "warnings": ()}
        if record.absent is not None:
            cells = np.column_stack([np.zeros_like(record.inputs, dtype=bool), record.absent])
            changed["absent"] = cells[:, list(self.order)][:, n_u:]
        return replace(record, **changed)

    def loosened(self, model: Model) -> Model:
        """``model`` without the bounds of the released parameters."""
        if not self.released:
            return model
        free = {name: {"lower": -math.inf, "upper": math.inf} for name in self.released}
        guesses = {p.name: p.guess for p in model.parameters}
        changed = {
            name: {**model.adjustments.get(name, {}), **b, "guess": guesses[name]} for name, b in free.items()
        }
        return replace(model, adjustments={**model.adjustments, **changed})


def hypotheses(model: Model, records: Sequence[Record], at_bound: Sequence[str]) -> list[Hypothesis]:
    """All that is tried; ``at_bound`` names the parameters that a fit left at a bound.

    Channels that do not move have no sign or unit that a fit could tell, and channels of one unit share a
    mistake: a reader of a file makes the same one with each.
    """
    channels = (*records[0].input_channels, *records[0].output_channels)
    n_u = len(records[0].input_channels)
    of = _columns(channels)
    moving = [k for k in range(len(channels)) if of[k] == k and _moves(records, k, n_u)]
    groups = _groups(channels, moving, n_u)
    found = [
        _changed("sign", f"the sign of {said} is reversed", of, n_u, columns, -1.0)
        for said, columns in groups
        if set(columns) <= set(range(n_u)) or len(columns) == 1
    ]
    for said, columns in groups:
        for unit, factor in _units(channels[columns[0]].unit):
            what = f"{said} is in {unit}"
            found.append(_changed("unit", what, of, n_u, columns, 1.0 / factor))
    lively = {k: _lively(records, k, n_u) for k in moving}
    for a, b in combinations(moving, 2):
        if (a < n_u) != (b < n_u) and lively[a] < SAMPLED * lively[b]:
            continue
        order = list(range(len(channels)))
        order[a], order[b] = b, a
        said = f"the columns of {_named(channels, a, n_u)} and {_named(channels, b, n_u)} are swapped"
        found.append(Hypothesis("swapped", said, (1.0,) * len(channels), tuple(order), n_u))
    if at_bound:
        said = f"{' and '.join(at_bound)} {'wants' if len(at_bound) == 1 else 'want'} to leave the bounds"
        found.append(
            Hypothesis(
                "bound", said, (1.0,) * len(channels), tuple(range(len(channels))), n_u, tuple(at_bound)
            )
        )
    return found


def _columns(channels: Sequence[Channel]) -> list[int]:
    """For each channel the one that stands for its column of the file: itself, if it was recorded, or the
    recorded one that it was made of. Where a model uses only what was made of it, the first of these."""
    recorded = [one.made_of or one.name for one in channels]
    names = [one.name for one in channels]
    return [names.index(one) if one in names else recorded.index(one) for one in recorded]


def _moves(records: Sequence[Record], k: int, n_u: int) -> bool:
    """Whether a channel moves within one of the records."""
    columns = (r.inputs[:, k] if k < n_u else r.outputs[:, k - n_u] for r in records)
    return any(bool(np.ptp(column) > 0) for column in columns)


def _lively(records: Sequence[Record], k: int, n_u: int) -> float:
    """The share of the samples at which a channel changes."""
    columns = [r.inputs[:, k] if k < n_u else r.outputs[:, k - n_u] for r in records]
    return float(np.mean(np.concatenate([np.diff(column) for column in columns]) != 0))


def _named(channels: Sequence[Channel], k: int, n_u: int) -> str:
    return f"{'input' if k < n_u else 'output'} {channels[k].name}"


def _groups(
    channels: Sequence[Channel], moving: Sequence[int], n_u: int
) -> list[tuple[str, tuple[int, ...]]]:
    """Each channel that moves, the inputs of one unit together, and all channels of one unit."""
    groups: list[tuple[str, tuple[int, ...]]] = [(_named(channels, k, n_u), (k,)) for k in moving]
    for among in ([k for k in moving if k < n_u], list(moving)):
        for unit in dict.fromkeys(channels[k].unit for k in among):
            columns = tuple(k for k in among if channels[k].unit == unit)
            said = " and ".join(_named(channels, k, n_u) for k in columns)
            if len(columns) > 1 and columns not in [known for _, known in groups]:
                groups.append((said, columns))
    return groups


def _changed(
    kind: Kind, said: str, of: Sequence[int], n_u: int, columns: Sequence[int], factor: float
) -> Hypothesis:
    """``columns`` times ``factor``, and what was made of them; ``of`` as ``_columns`` has it."""
    factors = tuple(factor if column in columns else 1.0 for column in of)
    return Hypothesis(kind, said, factors, tuple(range(len(of))), n_u)


def _units(unit: str) -> Iterator[tuple[str, float]]:
    """What a channel declared in ``unit`` may be in, with the number of those in one of ``unit``."""
    if unit in ("", "1"):
        return
    yield f"thousandths of {unit}", 1e3
    yield f"thousands of {unit}", 1e-3
    if unit.partition("/")[0] == "rad":
        per = unit.removeprefix("rad")
        yield f"degrees{per}", DEGREES
        yield f"rad{per}, taken for degrees{per}", 1.0 / DEGREES
    if unit == "rad/s":
        yield "turns per minute", RPM
    if unit in ("m/s²", "m/s^2"):
        yield "g", 1.0 / GRAVITY
    if unit == "m":
        yield "cm", 100.0
