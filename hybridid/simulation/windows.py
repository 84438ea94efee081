"""``Windows``: records cut into horizons, each simulated from an initial state of its own."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from hybridid.records.checks import have_one_step
from hybridid.records.record import Record
from hybridid.simulation.holds import all_held, stage_inputs
from hybridid.simulation.recent import Recent

Array = NDArray[np.float64]
CALL = 2500
"""Samples that one call of a compiled function simulates, over all horizons together."""
SHORTEST = 0.2
"""A last horizon shorter than this share of the others is omitted."""
_BY_HORIZON = ("time", "stages", "inputs", "outputs", "used", "cells")
PART = 2**16
"""Samples of many horizons that are computed with at once."""
HEAD = 10
"""Samples that must count in the first horizon after a masked stretch."""
ROOM = 2**27
"""Bytes that horizons may take which were cut before and may be asked for again."""


@dataclass(frozen=True)
class Windows:
    """``w`` horizons of ``length`` samples each, padded at their ends where ``used`` is False.

    One call simulates ``chunk`` samples of each, so ``length`` is a multiple of it.

    Shapes: ``time`` (w, length); ``stages`` (w, length, n_U) inputs of each step;
    ``inputs`` (w, length, n_u); ``outputs`` (w, length, n_y); ``used`` (w, length); ``cells`` (w, length,
    n_y), the outputs that were measured of the samples in use.
    ``origin`` gives (record index, first sample, end sample) of each. ``used`` is False where a record is
    masked, too. ``horizon`` is the length asked for: one that would end in a masked stretch ends after it.
    ``heads`` are (record index, first sample) of the horizons that begin a record, or begin anew after a
    masked stretch.
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
    cells: NDArray[np.bool_]
    origin: tuple[tuple[int, int, int], ...]
    horizon: int
    heads: frozenset[tuple[int, int]]

    @property
    def nbytes(self) -> int:
        """Memory that the samples take."""
        return sum(getattr(self, name).nbytes for name in _BY_HORIZON)

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
        arrays = {name: getattr(self, name)[rows] for name in _BY_HORIZON}
        return replace(self, **arrays, origin=tuple(self.origin[k] for k in rows))

    def without_ends(self, gap: int) -> Windows:
        """The same horizons with their last ``gap`` samples not in use."""
        ends = np.array(self.lengths)[:, None] - gap
        inside = np.arange(self.length) < ends
        return replace(self, used=self.used & inside, cells=self.cells & inside[..., None])

    def in_steps(self, records: Sequence[Record], substeps: int) -> Windows:
        """The same horizons of ``records``, the ones that were cut, in ``substeps`` steps a sample."""
        every = cut(records, self.horizon, substeps)
        place = {origin: k for k, origin in enumerate(every.origin)}
        same = every.select([place[origin] for origin in self.origin])
        return replace(same, used=self.used, cells=self.cells)

    @cached_property
    def holes(self) -> NDArray[np.bool_]:
        """Samples not in use before the last one in use of their horizon: masked ones, (w, length)."""
        return ~self.used & within(self.used)

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
        """Whether each horizon is a head or follows another horizon of these windows."""
        return all(head or before >= 0 for head, before in zip(self.is_head, self.follows, strict=True))

    @property
    def is_head(self) -> list[bool]:
        """Whether each horizon begins its record, or begins anew after a masked stretch; (w,)."""
        return [(record, start) in self.heads for record, start, _ in self.origin]

    @property
    def samples(self) -> int:
        """Number of samples in use."""
        return int(self.used.sum())

    @property
    def counts(self) -> NDArray[np.int64]:
        """Number of samples in use of each output, (n_y,)."""
        return self.cells.sum(axis=(0, 1))


_RECENT: Recent[Windows] = Recent(ROOM)


def within(used: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Each horizon up to its last sample that is ``used``, all (w, length)."""
    return np.logical_or.accumulate(used[:, ::-1], axis=1)[:, ::-1]


def in_parts(count: int, length: int) -> list[slice]:
    """``count`` horizons of ``length`` samples in parts of about ``PART`` samples: what is made of a part
    stays in the processor's cache, and the memory that one takes serves the next."""
    size = max(1, PART // length)
    return [slice(k, min(k + size, count)) for k in range(0, count, size)]


def cut(records: Sequence[Record], horizon: int | None, substeps: int, most: int | None = None) -> Windows:
    """Cut ``records`` into horizons of ``horizon`` samples (None: each record whole).

    ``most`` of them are kept, evenly chosen (None: all). Each begins and ends at a sample that counts.
    Those that were cut last are kept: a trace cuts the same ones for every refit.

    Raises:
        ValueError: if the records differ in sampling time, a horizon is shorter than 2, or the masks of the
            records leave no horizon.
    """
    key = (tuple(records), horizon, substeps, most)
    return _RECENT.get(key, lambda: _cut(*key))


def _cut(records: Sequence[Record], horizon: int | None, substeps: int, most: int | None) -> Windows:
    """``cut``, made anew."""
    dt = records[0].dt
    for record in records:
        if not have_one_step(record, records[0]):
            raise ValueError(
                f"records {records[0].name} and {record.name} differ in sampling time "
                f"({dt:g} s, {record.dt:g} s): resample one of them in preprocess"
            )
    length = max(r.n for r in records) if horizon is None else min(horizon, max(r.n for r in records))
    if length < 2:
        raise ValueError(f"horizon of {length} samples: at least 2 are needed")
    held = all(all_held(record) for record in records)
    origin = _origins(records, length)
    heads = _heads(origin)
    if not origin:
        names = " and ".join(record.name for record in records)
        raise ValueError(f"the mask leaves no horizon of {names}: no stretch has {HEAD} samples that count")
    if most is not None:
        origin = [origin[k] for k in np.unique(np.linspace(0, len(origin) - 1, most).astype(int))]
    longest = max(length, *(stop - start for _, start, stop in origin))
    chunk = min(longest, max(100, CALL // len(origin)))
    padded = -(-longest // chunk) * chunk
    pieces = [_piece(records[index], held, substeps, start, stop, padded) for index, start, stop in origin]
    time, staged, inputs, outputs = (np.stack([piece[k] for piece in pieces]) for k in range(4))
    ends = np.array([stop - start for _, start, stop in origin])
    used = np.arange(padded) < ends[:, None]
    for row, (index, start, stop) in zip(used, origin, strict=True):
        if records[index].masked:
            row[: stop - start] = records[index].counts[start:stop]
    cells = np.repeat(used[..., None], outputs.shape[2], axis=2)
    for row, (index, start, stop) in zip(cells, origin, strict=True):
        if records[index].absent is not None:
            row[: stop - start] = records[index].cells[start:stop]
    parts = (time, staged, inputs, outputs, used, cells)
    return Windows(dt, held, substeps, chunk, *parts, tuple(origin), length, heads)


def _origins(records: Sequence[Record], length: int) -> list[tuple[int, int, int]]:
    """(record index, first sample, end sample) of each horizon of ``length`` samples."""
    return [
        (index, start, stop)
        for index, record in enumerate(records)
        for start, stop in (_between_masks if record.masked else _even)(record, length)
    ]


def _even(record: Record, length: int) -> list[tuple[int, int]]:
    """First and end sample of each horizon of a record that counts everywhere."""
    return [
        (start, min(start + length, record.n))
        for start in range(0, record.n, length)
        if start == 0 or record.n - start >= SHORTEST * length
    ]


def _between_masks(record: Record, length: int) -> list[tuple[int, int]]:
    """First and end sample of each horizon of a masked record.

    A horizon that would end in a masked stretch goes on to the stretch's end, so that the next takes over an
    effect's inner states; not if the stretch is longer than a horizon.
    """
    found: list[tuple[int, int]] = []
    counting = np.flatnonzero(record.counts)
    for first, end in record.joined:
        start, head = first, True
        while start < end:
            stop = min(start + length, end)
            following = int(np.searchsorted(counting, stop))
            after = int(counting[following]) if stop < end else end
            stop = after if after - stop <= length else int(counting[following - 1]) + 1
            least = min(HEAD, SHORTEST * length) if head else SHORTEST * length
            enough = record.counts[start:stop].sum() >= least
            found += [(start, stop)] if enough else []
            start, head = after, not enough or after != stop
    return found


def _heads(origin: Sequence[tuple[int, int, int]]) -> frozenset[tuple[int, int]]:
    """(record index, first sample) of the horizons that no other one leads up to."""
    ends = {(record, stop) for record, _, stop in origin}
    return frozenset((record, start) for record, start, _ in origin if (record, start) not in ends)


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
