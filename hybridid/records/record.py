"""``Record``: one recording of a machine, checked when it is made and never changed."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from hybridid.naming import unknown
from hybridid.records.channel import HOLDS, Array, Channel, Hold, RecordError, Signals
from hybridid.records.checks import check_samples
from hybridid.records.masked import (
    APART,
    COUNTS,
    THROUGH,
    Cells,
    Counts,
    Levels,
    Masked,
    levels_of,
    masked_of,
    pieces,
)

__all__ = ["HOLDS", "Array", "Channel", "Hold", "Record", "RecordError"]


@dataclass(frozen=True, eq=False)
class Record:
    """One evenly sampled recording.

    Shapes: ``time`` (n,) in s, ``inputs`` (n, n_u), ``outputs`` (n, n_y),
    ``auxiliary`` (n, n_a) for signals that a plot shows but no model uses (``with_channels`` lets one).
    ``simulated`` marks whatever comes from a virtual rig; it travels with every result.
    ``digest`` is the SHA-256 of the file it came from, or of the rig's configuration.
    ``warnings`` are one line each: those of reading and preprocessing, and those of its own check.
    ``masked`` are the stretches of samples that do not count (``with_masked``). ``absent`` (n, n_y) marks the
    cells of ``outputs`` that were not measured, where another output was; None: there are none. They hold
    interpolated values.

    Raises:
        RecordError: if shapes or lengths disagree, a value is not finite, the time
            stamps are not even and increasing, the record is too short, or too few samples count.
    """

    name: str
    time: Array
    inputs: Array
    outputs: Array
    input_channels: tuple[Channel, ...]
    output_channels: tuple[Channel, ...]
    auxiliary: Array | None = None
    auxiliary_channels: tuple[Channel, ...] = ()
    simulated: bool = False
    source: str = ""
    digest: str = ""
    warnings: tuple[str, ...] = field(default=())
    masked: tuple[Masked, ...] = ()
    absent: Cells | None = None
    _seen_by_check: tuple[str, ...] = field(init=False, repr=False, default=())

    def __post_init__(self) -> None:
        for name in ("time", "inputs", "outputs", "auxiliary"):
            value = getattr(self, name)
            if value is not None:
                object.__setattr__(self, name, self._frozen(name, value))
        if self.absent is not None:
            self._set_absent(self.absent)
        cells = self.cells if self.partly else None
        seen = check_samples(self.name, self.time, self._signals(), cells)
        object.__setattr__(self, "_seen_by_check", seen)
        # a copy takes its warnings with it, and its check finds them again
        found = dict.fromkeys((*self.warnings, *self._seen_by_check))
        object.__setattr__(self, "warnings", tuple(found))

    def _frozen(self, name: str, value: Array) -> Array:
        try:
            frozen = np.array(value, dtype=float, copy=True)
        except (TypeError, ValueError) as wrong:
            raise RecordError(f"record {self.name}: {name} is not an array of numbers: {wrong}") from wrong
        frozen.flags.writeable = False
        return frozen

    def _set_absent(self, absent: Cells) -> None:
        """Check and freeze ``absent``. A sample without any output is masked, and simulated through."""
        cells = np.array(absent, dtype=bool)
        if cells.shape != self.outputs.shape:
            raise RecordError(
                f"record {self.name}: absent has shape {cells.shape}, the outputs {self.outputs.shape}"
            )
        nothing: Counts = np.logical_and.reduce(cells, axis=1)
        if nothing.any():
            levels = np.maximum(self.levels, np.where(nothing, THROUGH, COUNTS)).astype(np.int8)
            object.__setattr__(self, "masked", masked_of(levels))
            cells &= ~nothing[:, None]
        cells.flags.writeable = False
        object.__setattr__(self, "absent", cells if cells.any() else None)

    def _signals(self) -> tuple[Signals, ...]:
        """Inputs, outputs and, if there are any, auxiliary signals."""
        own = (
            Signals("inputs", self.inputs, self.input_channels),
            Signals("outputs", self.outputs, self.output_channels),
        )
        if self.auxiliary is None and not self.auxiliary_channels:
            return own
        auxiliary = np.empty((self.time.size, 0)) if self.auxiliary is None else self.auxiliary
        return (*own, Signals("auxiliary signals", auxiliary, self.auxiliary_channels))

    @property
    def n(self) -> int:
        """Number of samples."""
        return len(self.time)

    @cached_property
    def counts(self) -> Counts:
        """Which samples count, (n,): all that are not masked."""
        return self.levels == 0

    @property
    def levels(self) -> Levels:
        """Whether each sample counts, is masked, or is masked and not simulated, (n,), in the numbers of
        ``hybridid.records.masked``."""
        return levels_of(self.masked, self.n)

    @property
    def cells(self) -> Cells:
        """Which cells of the outputs count, (n, n_y): measured, and not masked."""
        counts = np.repeat(self.counts[:, None], self.outputs.shape[1], axis=1)
        return counts if self.absent is None else counts & ~self.absent

    @property
    def whole(self) -> Counts:
        """Which samples count with all their outputs, (n,)."""
        found: Counts = np.logical_and.reduce(self.cells, axis=1)
        return found

    @property
    def measured(self) -> Array:
        """The outputs, nan where they were not measured, (n, n_y)."""
        return self.outputs if self.absent is None else np.where(self.absent, np.nan, self.outputs)

    @property
    def counted(self) -> Array:
        """The outputs at the samples that count, nan where they were not measured, (m, n_y)."""
        return self.measured[self.counts] if self.masked else self.measured

    @property
    def pieces(self) -> list[tuple[int, int]]:
        """First and end sample of each stretch in which all samples count."""
        return pieces(self.counts) if self.masked else [(0, self.n)]

    @property
    def joined(self) -> list[tuple[int, int]]:
        """First and end sample of each stretch that can be simulated in one go; both ends count."""
        if not self.masked:
            return [(0, self.n)]
        counting = [
            (first + np.flatnonzero(self.counts[first:end]))
            for first, end in pieces(self.levels < APART)
            if self.counts[first:end].any()
        ]
        return [(int(samples[0]), int(samples[-1]) + 1) for samples in counting]

    @property
    def dt(self) -> float:
        """Sampling time in s."""
        return float((self.time[-1] - self.time[0]) / (self.n - 1))

    @property
    def provenance(self) -> str:
        """``"simulated"`` or ``"measured"``, to be printed beside every number."""
        return "simulated" if self.simulated else "measured"

    @property
    def channels(self) -> tuple[Channel, ...]:
        """Every channel: inputs, outputs, auxiliary."""
        return (*self.input_channels, *self.output_channels, *self.auxiliary_channels)

    def output(self, name: str) -> Array:
        """The output channel ``name``, shape (n,).

        Raises:
            RecordError: if the record has no such output.
        """
        return self.outputs[:, self._index("output", name, self.output_channels)]

    def input(self, name: str) -> Array:
        """The input channel ``name``, shape (n,).

        Raises:
            RecordError: if the record has no such input.
        """
        return self.inputs[:, self._index("input", name, self.input_channels)]

    def signal(self, name: str) -> Array:
        """The input, output or auxiliary channel ``name``, shape (n,).

        Raises:
            RecordError: if the record has no such signal.
        """
        column = self._index("signal", name, self.channels)
        parts = (self.inputs, self.outputs, self.auxiliary)
        return np.hstack([part for part in parts if part is not None])[:, column]

    def _index(self, what: str, name: str, channels: tuple[Channel, ...]) -> int:
        names = [channel.name for channel in channels]
        if name not in names:
            raise RecordError(f"record {self.name}: {unknown(what, name, names)}")
        return names.index(name)

    def with_channels(self, names: Sequence[str]) -> Record:
        """The record with the auxiliary signals ``names`` as further inputs: the channels of a model.

        Raises:
            RecordError: if it has no auxiliary signal of one of the names.
        """
        if not names:
            return self
        chosen = [self._index("auxiliary signal", name, self.auxiliary_channels) for name in names]
        assert self.auxiliary is not None
        left = [k for k in range(len(self.auxiliary_channels)) if k not in chosen]
        # how a channel runs between samples matters little: a trace need not vary it
        channels = (replace(self.auxiliary_channels[k], assumed=False) for k in chosen)
        return replace(
            self,
            inputs=np.column_stack([self.inputs, self.auxiliary[:, chosen]]),
            input_channels=(*self.input_channels, *channels),
            auxiliary=self.auxiliary[:, left] if left else None,
            auxiliary_channels=tuple(self.auxiliary_channels[k] for k in left),
        )

    def with_constants(self, values: Mapping[str, float], units: Mapping[str, str]) -> Record:
        """The record with further inputs that keep the same value from its first sample to its last: what the
        parameters were that a model takes from each record."""
        if not values:
            return self
        columns = np.tile(np.array(list(values.values()), dtype=float), (self.n, 1))
        channels = tuple(Channel(name, units[name], "zoh", constant=True) for name in values)
        return replace(
            self,
            inputs=np.hstack([self.inputs, columns]),
            input_channels=(*self.input_channels, *channels),
        )

    def with_masked(self, levels: Levels) -> Record:
        """The record with the samples masked as ``levels`` (n,) says, and with no others.

        Raises:
            RecordError: if too few samples count.
        """
        kept = tuple(w for w in self.warnings if w not in self._seen_by_check)
        return replace(self, masked=masked_of(levels), warnings=kept)

    @property
    def partly(self) -> bool:
        """Whether not every cell of the outputs counts."""
        return bool(self.masked) or self.absent is not None

    def unmasked(self) -> Record:
        """The record with all its samples counting."""
        return replace(self, masked=(), absent=None) if self.partly else self

    def part(self, start: int, stop: int, name: str | None = None) -> Record:
        """Samples ``start`` to ``stop`` (exclusive) as a record of their own.

        The part keeps the warnings about how the record was made. It is checked again.

        Raises:
            RecordError: if the part is too short.
        """
        cut = slice(start, stop)
        return replace(
            self,
            name=name or self.name,
            time=self.time[cut],
            inputs=self.inputs[cut],
            outputs=self.outputs[cut],
            auxiliary=None if self.auxiliary is None else self.auxiliary[cut],
            warnings=tuple(w for w in self.warnings if w not in self._seen_by_check),
            masked=masked_of(self.levels[cut]) if self.masked else (),
            absent=None if self.absent is None else self.absent[cut],
        )
