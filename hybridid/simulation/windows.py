"""``Windows``: records cut into horizons, each simulated from an initial state of its own."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from hybridid.records.record import Record
from hybridid.simulation.holds import all_held, stage_inputs

Array = NDArray[np.float64]
CALL = 2500
"""Samples that one call of a compiled function simulates, over all horizons together."""
SHORTEST = 0.2
"""A last horizon shorter than this share of the others is omitted."""


@dataclass(frozen=True)
class Windows:
    """``w`` horizons of ``length`` samples each, padded at their ends where ``used`` is False.

    One call simulates ``chunk`` samples of each, so ``length`` is a multiple of it.

    Shapes: ``time`` (w, length); ``stages`` (w, length, n_U) inputs of each step;
    ``inputs`` (w, length, n_u); ``outputs`` (w, length, n_y); ``used`` (w, length).
    ``origin`` gives (record index, first sample, end sample) of each.
    """

    dt: float
    held: bool
    substeps: int
    chunk: int
    time: Array
    stages: Array
    inputs: Array
    outputs: Array
    used: NDArray[np.bool_]
    origin: tuple[tuple[int, int, int], ...]

    @property
    def count(self) -> int:
        """Number of horizons, w."""
        return len(self.origin)

    @property
    def length(self) -> int:
        """Samples of the longest horizon after padding."""
        return self.time.shape[1]

    def select(self, chosen: Sequence[int]) -> Windows:
        """The horizons with these indices only, in this order."""
        rows = list(chosen)
        arrays = {name: getattr(self, name)[rows] for name in ("time", "stages", "inputs", "outputs", "used")}
        return replace(self, **arrays, origin=tuple(self.origin[k] for k in rows))

    def without_ends(self, gap: int) -> Windows:
        """The same horizons with their last ``gap`` samples not in use."""
        ends = np.array(self.lengths)[:, None] - gap
        return replace(self, used=self.used & (np.arange(self.length) < ends))

    @cached_property
    def lengths(self) -> tuple[int, ...]:
        """Samples of each horizon."""
        return tuple(stop - start for _, start, stop in self.origin)

    @cached_property
    def follows(self) -> tuple[int, ...]:
        """For each horizon the index of the earlier one that ends where it begins; -1 without one; (w,)."""
        ends = {(record, stop): k for k, (record, _, stop) in enumerate(self.origin)}
        before = (ends.get((record, start), -1) for record, start, _ in self.origin)
        return tuple(b if b < k else -1 for k, b in enumerate(before))

    @property
    def complete(self) -> bool:
        """Whether each horizon begins with its record or follows another horizon of these windows."""
        starts = (start for _, start, _ in self.origin)
        return all(start == 0 or before >= 0 for start, before in zip(starts, self.follows, strict=True))

    @property
    def samples(self) -> int:
        """Number of samples in use."""
        return int(self.used.sum())


def cut(records: Sequence[Record], horizon: int | None, substeps: int, most: int | None = None) -> Windows:
    """Cut ``records`` into horizons of ``horizon`` samples (None: each record whole).

    ``most`` of them are kept, evenly chosen (None: all).

    Raises:
        ValueError: if the records differ in sampling time or a horizon is shorter than 2.
    """
    dt = records[0].dt
    for record in records:
        if abs(record.dt - dt) > 1e-6 * dt:
            raise ValueError(
                f"records {records[0].name} and {record.name} differ in sampling time "
                f"({dt:g} s, {record.dt:g} s): resample one of them in preprocess"
            )
    length = max(r.n for r in records) if horizon is None else min(horizon, max(r.n for r in records))
    if length < 2:
        raise ValueError(f"horizon of {length} samples: at least 2 are needed")
    held = all(all_held(record) for record in records)
    origin = _origins(records, length)
    if most is not None:
        origin = [origin[k] for k in np.unique(np.linspace(0, len(origin) - 1, most).astype(int))]
    chunk = min(length, max(100, CALL // len(origin)))
    padded = -(-length // chunk) * chunk
    pieces = [_piece(records[index], held, substeps, start, stop, padded) for index, start, stop in origin]
    time, staged, inputs, outputs = (np.stack([piece[k] for piece in pieces]) for k in range(4))
    ends = np.array([stop - start for _, start, stop in origin])
    used = np.arange(padded) < ends[:, None]
    return Windows(dt, held, substeps, chunk, time, staged, inputs, outputs, used, tuple(origin))


def _origins(records: Sequence[Record], length: int) -> list[tuple[int, int, int]]:
    """(record index, first sample, end sample) of each horizon of ``length`` samples."""
    return [
        (index, start, min(start + length, record.n))
        for index, record in enumerate(records)
        for start in range(0, record.n, length)
        if start == 0 or record.n - start >= SHORTEST * length
    ]


def _piece(
    record: Record, held: bool, substeps: int, start: int, stop: int, length: int
) -> tuple[Array, ...]:
    """One horizon's time, stages, inputs and outputs, its last sample repeated to ``length``.

    A held record has the stages of one that is not, unless all are ``held``.
    """
    stages = stage_inputs(record, substeps, start, stop)
    if all_held(record) and not held:
        stages = np.tile(stages, (1, 2 * substeps + 1))
    index = np.minimum(np.arange(start, start + length), stop - 1)
    return record.time[index], stages[index - start], record.inputs[index], record.outputs[index]
