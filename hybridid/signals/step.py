"""``Step``: one change to a record's signals, and the helpers that steps share."""

from __future__ import annotations

import abc
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np

from hybridid.records.masked import Cells
from hybridid.records.record import Array, Channel, Hold, Record

Role = Literal["output", "input", "auxiliary"]


class StepError(ValueError):
    """Raised for a step that cannot be done: the message says which, why, and what is allowed."""


def as_steps(given: Any, where: str) -> tuple[Any, ...]:
    """The steps of a config as a tuple; none for null.

    Raises:
        StepError: if it is no list.
    """
    if given is None:
        return ()
    if isinstance(given, str | Mapping) or not isinstance(given, Sequence):
        raise StepError(f"{where} is {given!r}: give a list of steps, as in [{{step: decimate, factor: 10}}]")
    return tuple(given)


class Step(abc.ABC):
    """One configured change: ``apply`` returns a new record and leaves the given one as it was.

    A step is a frozen dataclass whose fields are the keys of its config.
    """

    @abc.abstractmethod
    def apply(self, record: Record) -> Record:
        """The record after the step.

        Raises:
            StepError: if a value does not suit the record (a cutoff above its Nyquist frequency).
            RecordError: if the record has no such signal, or the result is not a valid record.
        """

    @property
    def touched(self) -> tuple[str, ...]:
        """The signals that the step reads or changes."""
        return ()

    @property
    def causal_filter(self) -> str:
        """A causal filter of the step in words, such as its order and cutoff [Hz]; empty without one."""
        return ""


@dataclass(frozen=True)
class Target:
    """The place of a signal that a step makes from ``source``.

    A signal with a new ``name`` is appended in ``role``; a new input runs straight from sample to sample
    (``foh``), as what was measured does. With the source's own name, it replaces the
    source. With ``demote``, the source becomes auxiliary and the new signal takes its place.
    """

    source: str
    name: str
    unit: str
    role: Role = "output"
    demote: bool = False

    def placed(self, record: Record, values: Array) -> Record:
        """``record`` with ``values`` (n,) as the signal ``name``.

        Raises:
            StepError: if another signal has that name.
        """
        if self.name == self.source:
            changed = edited(record, {self.name: values}, self.unit)
            channels = (replace(c, noise=0.0) if c.name == self.name else c for c in changed.output_channels)
            return replace(changed, output_channels=tuple(channels))
        if self.name in {channel.name for channel in record.channels}:
            raise StepError(f"record {record.name} already has a signal {self.name!r}; choose another name")
        hold: Hold = "foh" if self.role == "input" else "zoh"
        channel = Channel(self.name, self.unit, hold, made_of=_recorded(record, self.source))
        appended = _appended(record, channel, values, self.role, self.source)
        return _demoted(appended, self.source, self.role == "output") if self.demote else appended


def _recorded(record: Record, source: str) -> str:
    """The recorded signal that ``source`` is, or was itself made of."""
    return next(c.made_of for c in record.channels if c.name == source) or source


def in_place(
    record: Record, names: tuple[str, ...], change: Callable[[Array], Array], unit: str | None = None
) -> Record:
    """``record`` with ``change`` applied to each of the signals ``names``, in ``unit`` if given.

    Raises:
        StepError: if there is no name.
        RecordError: if the record has no signal of one of the names.
    """
    if not names:
        raise StepError("signals is []: give at least one signal")
    return edited(record, {name: change(record.signal(name)) for name in names}, unit)


def edited(record: Record, values: Mapping[str, Array], unit: str | None = None) -> Record:
    """``record`` with the signals ``values`` (name to (n,)) in place of its own, in ``unit`` if given."""

    def part(matrix: Array, channels: tuple[Channel, ...]) -> tuple[Array, tuple[Channel, ...]]:
        columns = [values.get(c.name, matrix[:, j]) for j, c in enumerate(channels)]
        changed = [replace(c, unit=c.unit if unit is None else unit, rounding=0.0) for c in channels]
        own = tuple(new if c.name in values else c for c, new in zip(channels, changed, strict=True))
        return (np.column_stack(columns) if columns else matrix), own

    inputs, input_channels = part(record.inputs, record.input_channels)
    outputs, output_channels = part(record.outputs, record.output_channels)
    auxiliary, auxiliary_channels = part(_auxiliary(record), record.auxiliary_channels)
    return replace(
        record,
        inputs=inputs,
        outputs=outputs,
        auxiliary=auxiliary if auxiliary_channels else None,
        input_channels=input_channels,
        output_channels=output_channels,
        auxiliary_channels=auxiliary_channels,
    )


def _appended(record: Record, channel: Channel, values: Array, role: Role, source: str) -> Record:
    if role == "output":
        return replace(
            record,
            outputs=np.column_stack([record.outputs, values]),
            output_channels=(*record.output_channels, channel),
            absent=_absent_with(record, source),
        )
    if role == "input":
        return replace(
            record,
            inputs=np.column_stack([record.inputs, values]),
            input_channels=(*record.input_channels, channel),
        )
    return replace(
        record,
        auxiliary=np.column_stack([_auxiliary(record), values]),
        auxiliary_channels=(*record.auxiliary_channels, channel),
    )


def _absent_with(record: Record, source: str) -> Cells | None:
    """The absent cells with one more output, which is missing where ``source`` is."""
    if record.absent is None:
        return None
    names = [channel.name for channel in record.output_channels]
    own = record.absent[:, names.index(source)] if source in names else np.zeros(record.n, dtype=bool)
    return np.column_stack([record.absent, own])


def _demoted(record: Record, name: str, made: bool) -> Record:
    """The output ``name`` as an auxiliary signal; inputs and auxiliary signals stay what they are.

    If the last output was ``made`` from it, that output moves to the place of ``name``: the outputs keep
    the order in which a plant expects them.
    """
    names = [channel.name for channel in record.output_channels]
    if name not in names:
        return record
    j = names.index(name)
    kept = [*range(j), *([len(names) - 1] if made else []), *range(j + 1, len(names) - made)]
    return replace(
        record,
        outputs=record.outputs[:, kept],
        absent=None if record.absent is None else record.absent[:, kept],
        output_channels=tuple(record.output_channels[k] for k in kept),
        auxiliary=np.column_stack([_auxiliary(record), record.outputs[:, j]]),
        auxiliary_channels=(*record.auxiliary_channels, record.output_channels[j]),
    )


def _auxiliary(record: Record) -> Array:
    return np.empty((record.n, 0)) if record.auxiliary is None else record.auxiliary
