"""Checks that records have a model's signals: names, order and units."""

from __future__ import annotations

from collections.abc import Sequence

from hybridid.model import Model
from hybridid.naming import listed
from hybridid.records.record import Record
from hybridid.records.units import factor


def check_records(model: Model, records: Sequence[Record]) -> None:
    """Check that every record has the model's signals, in its units.

    Raises:
        ValueError: if one has not, or there is no record.
    """
    if not records:
        raise ValueError("no record to work on: at least one is needed")
    for record in records:
        _check_signals(model, record)


def _check_signals(model: Model, record: Record) -> None:
    pairs = (
        ("inputs", record.input_channels, model.inputs),
        ("outputs", record.output_channels, model.outputs),
    )
    for what, channels, signals in pairs:
        have, want = [c.name for c in channels], [s.name for s in signals]
        if have != want:
            raise ValueError(
                f"record {record.name} has the {what} {listed(have)}, {_who(model)} needs {listed(want)}"
            )
        for channel, signal in zip(channels, signals, strict=True):
            if channel.unit != signal.unit:
                raise ValueError(
                    f"record {record.name}: {channel.name} is in {channel.unit or 'no unit'}, "
                    f"{_who(model)} needs {signal.unit}{_converted(channel.unit, signal.unit)}"
                )


def _converted(unit: str, into: str) -> str:
    """How a signal gets another unit, where a factor turns one into the other."""
    scale = factor(unit, into) if unit else None
    return (
        "" if scale is None else f": give it unit: {into}, and scale: {scale:.6g} if its column is in {unit}"
    )


def _who(model: Model) -> str:
    return f"plant {model.plant.name}{' with its channels' if model.channels else ''}"
