"""What a recording tells of itself: its time axis, and the unit of each column and how it is held."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import islice
from typing import NamedTuple

import numpy as np

from hybridid.records.channel import Array, RecordError
from hybridid.records.checks import check_even, check_increasing
from hybridid.records.columns import Columns
from hybridid.records.mapping import SECONDS, TimeMap
from hybridid.records.units import factor, is_unit
from hybridid.records.usual_step import UsualStep, usual_step

TIME_NAMES = ("t", "time", "timestamp", "stamp", "stamps", "ts", "epoch", "seconds", "zeit", "temps", "tempo")
SINCE_1970 = (1e9, 4e9)
"""Seconds since 1970 of the years 2001 to 2096."""
EXPLAINED = 2
"""Columns that are none, of which the line that asks for time says why."""
HELD = 0.5
"""Share of the steps without a change from which on a signal is taken to be held between its changes."""
_BRACKETS = re.compile(r"^(?P<label>.+?)\s*[\[(](?P<unit>[^\[\]()]+)[\])]$")
_UNIT_AT_END = (
    _BRACKETS,
    re.compile(r"^(?P<label>.+?)\s+in\s+(?P<unit>\S+)$"),
    re.compile(r"^(?P<label>.+)_(?P<unit>[^_]+)$"),
)
_RATE_AT_END = re.compile(r"^(?P<label>.+)_(?P<unit>rad|deg|rev|[mck]?m|[lL]|m3|kg)_(?P<per>s2?|min|h)$")
"""A rate whose stroke is an underscore: ``speed_rad_s``."""


class Labelled(NamedTuple):
    """The name of a column without the unit in it; ``unit`` is empty where it names none."""

    label: str
    unit: str


@dataclass(frozen=True)
class TimeFound:
    """The time axis: its ``column``, in a ``unit`` of ``SECONDS`` (``assumed`` where no header told it), the
    ``usual`` step in s, and whether the stamps are ``even``. Without a column they are 0, ``step``, ...
    ``same`` are further columns with the same stamps, of other files of the recording."""

    column: str | None
    unit: str
    assumed: bool
    usual: UsualStep
    even: bool
    same: tuple[str, ...] = ()

    @property
    def step(self) -> float:
        """The usual step in s."""
        return self.usual.seconds


class NoTimeError(RecordError):
    """Nothing looks like time, or several columns do: the user must say which."""


@dataclass(frozen=True)
class ColumnFound:
    """A column of numbers: its ``name`` in the file, ``label`` and ``unit`` therein, and its values (n,)."""

    name: str
    label: str
    unit: str
    values: Array

    @property
    def constant(self) -> bool:
        """Whether it never changes."""
        return bool(np.ptp(self.values) == 0) if len(self.values) else True

    @property
    def held(self) -> bool:
        """Whether it keeps its value over most steps, as the command of a slower controller does."""
        return bool(np.mean(np.diff(self.values) == 0) >= HELD) and not self.constant


def labelled(name: str) -> Labelled:
    """``angle [deg]``, ``angle (deg)``, ``angle in deg`` and ``angle_deg`` as (``angle``, ``deg``);
    ``speed_rad_s`` as (``speed``, ``rad/s``)."""
    if rate := _RATE_AT_END.match(name):
        return Labelled(rate["label"], f"{rate['unit']}/{rate['per']}")
    for pattern in _UNIT_AT_END:
        match = pattern.match(name)
        if match and not match["unit"].isdigit() and (pattern is _BRACKETS or is_unit(match["unit"])):
            return Labelled(match["label"], match["unit"].strip())
    return Labelled(name, "")


def columns_found(columns: Columns) -> tuple[ColumnFound, ...]:
    """The columns that may be signals: no dates; as many samples as the longest, or stamps of their own."""
    longest = max(len(values) for values in columns.values())
    return tuple(
        ColumnFound(name, *labelled(name), values)
        for name, values in columns.items()
        if (len(values) == longest or name in columns.clocks) and name not in columns.instants
    )


def time_found(
    columns: Columns, column: str | None = None, step: float | None = None, unit: str | None = None
) -> TimeFound:
    """The time axis of a file: ``column`` where it is given, else ``step`` in s, else what looks like one.
    ``unit`` of ``SECONDS`` is that of its stamps (None: as the header says).

    A column looks like time if its name says so, without its file's. If none does: if it alone holds dates;
    then if the last part of its name says so, as of ``log.t``; then if it alone is in a unit of time and
    increases. Stamps without a unit are in s, or in the unit in which they count from 1970.

    Raises:
        NoTimeError: if nothing looks like time, or several columns that differ do.
        RecordError: if its unit is none of time, or if the stamps do not increase.
    """
    if column is None and step is not None:
        return TimeFound(None, "s", False, UsualStep(step, 0.0), True)
    name, *same = [column] if column is not None else _looks_like_time(columns)
    stamps = columns[name]
    told = unit or _unit_of_time(name, columns)
    unit = told or _since_1970(stamps)
    seconds = stamps * SECONDS[unit]
    where = f"{columns.path}: {name}"
    if len(seconds) < 2 or not np.isfinite(seconds).all():
        raise RecordError(f"{where} cannot be time: stamps are missing")
    check_increasing(seconds, where)
    try:
        check_even(seconds, where)
        even = True
    except RecordError:
        even = False
    return TimeFound(name, unit, not told, usual_step(seconds), even, tuple(same))


def other_unit_of_time(time: TimeMap) -> str:
    """That the header of the column of ``time`` names another unit than it is read in; else empty."""
    unit = labelled(time.column or "").unit
    seconds = factor(unit, "s") if unit else None
    if seconds is None or np.isclose(seconds, SECONDS[time.unit]):
        return ""
    column = f"its column {time.column!r} says {unit}"
    return f"time is read in {time.unit}, but {column}: is signals.time.unit right?"


def _looks_like_time(columns: Columns) -> list[str]:
    """The column that looks like time, and those that agree with it."""
    longest = max(len(values) for values in columns.values())
    whole = [name for name, values in columns.items() if len(values) == longest]
    found = (
        [name for name in whole if _is_named_time(name)]
        or [name for name in whole if _is_named_time(name.rpartition(":")[2])]
        or [name for name in whole if name in columns.instants]
        or [name for name in whole if _is_named_time(name.rpartition(".")[2])]
        or [name for name in whole if _in_seconds(name) and np.all(np.diff(columns[name]) > 0)]
    )
    if found and all(np.array_equal(columns[name], columns[found[0]], equal_nan=True) for name in found):
        return found
    if found:
        raise NoTimeError(f"{columns.path}: several columns look like time: {', '.join(found)}")
    rising = [name for name in whole if _rises_evenly(columns[name])]
    but = f"; {rising[0]} rises evenly, as time does" if rising else ""
    texts = "".join(f"; {name}: {why}" for name, why in islice(columns.unusable.items(), EXPLAINED))
    raise NoTimeError(f"{columns.path}: no column is called time: {', '.join(whole)}{but}{texts}")


def _is_named_time(name: str) -> bool:
    return _plain(labelled(name).label) in TIME_NAMES


def _in_seconds(name: str) -> bool:
    """Whether a column's header names a unit of time."""
    unit = labelled(name).unit
    return bool(unit) and factor(unit, "s") in SECONDS.values()


def _since_1970(stamps: Array) -> str:
    """The unit in which stamps count from 1970, of those whose header names none; s if they do not."""
    low, high = SINCE_1970
    first = float(stamps[0]) if len(stamps) else 0.0
    return next((unit for unit in ("ms", "us", "ns") if low <= first * SECONDS[unit] <= high), "s")


def _rises_evenly(values: Array) -> bool:
    """Whether all steps are positive and as long as the others, as of a clock or a counter."""
    steps = np.diff(values)
    return bool(len(steps) > 1 and steps.min() > 0 and np.ptp(steps) <= 1e-3 * steps.max())


def _unit_of_time(name: str, columns: Columns) -> str:
    """The unit that a name or dates tell, as a key of ``SECONDS``; empty if neither does."""
    if name in columns.instants:
        return "s"
    unit = labelled(name).unit
    if not unit:
        return ""
    in_seconds = factor(unit, "s")
    found = next((known for known, value in SECONDS.items() if value == in_seconds), "")
    if not found:
        raise RecordError(
            f"{columns.path}: time column {name!r} is in {unit}; allowed: {', '.join(SECONDS)}; give the "
            "sampling rate if it counts samples"
        )
    return found


def _plain(label: str) -> str:
    return re.sub(r"\W+", "", label).lower()


def words_of(label: str) -> Iterator[str]:
    """The words of a name: ``motorCurrent_1`` as motor, current, 1."""
    apart = re.sub(r"([a-z0-9])([A-Z])", r"\1 \2", label)
    yield from (word.lower() for word in re.split(r"[\W_]+", apart) if word)
