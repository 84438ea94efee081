"""Stamps that a file gives as text: dates with a time of day, or times of day alone.

Read are ``2026-11-25T14:00:01.5Z`` (ISO 8601, also with a space, and with an offset from UTC),
``2026/11/25 14:00:01.5``, ``25.11.2026 14:00:01,5`` and ``14:00:01.5``. A time of day goes on over midnight.
``11/25/2026 02:00:01 PM`` does not say whether day or month comes first: it is read where all cells have one
date, so that only the time of day counts.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from datetime import date

import numpy as np
from numpy.typing import NDArray

DAY = 86400.0
"""Seconds."""
_SECONDS = r":(?P<s>\d{2}(?:[.,]\d+)?)"
_MINUTES = r"(?P<h>\d{1,2}):(?P<m>\d{2})"
_CLOCK = rf"{_MINUTES}(?:{_SECONDS})?"
_ZONE = r"(?P<zone>Z|[+-]\d{2}:?\d{2})?"
_SHAPES = tuple(
    re.compile(shape)
    for shape in (
        rf"(?P<Y>\d{{4}})(?P<sep>[-/])(?P<M>\d{{2}})(?P=sep)(?P<D>\d{{2}})[T ]{_CLOCK}{_ZONE}",
        rf"(?P<D>\d{{1,2}})\.(?P<M>\d{{1,2}})\.(?P<Y>\d{{4}})[T ]{_CLOCK}",
        rf"(?P<any>\d{{1,2}}/\d{{1,2}}/\d{{2,4}}) {_CLOCK}(?: ?(?P<half>[AaPp][Mm]))?",
        rf"{_MINUTES}{_SECONDS}",
    )
)


def seconds_of(cells: Sequence[str | None]) -> NDArray[np.float64] | None:
    """Seconds since the first of ``cells`` (n,), (n,), missing ones as NaN; None where one is no such stamp,
    or where they have several dates of which day and month cannot be told apart."""
    first = next((cell for cell in cells if cell is not None), "").strip()
    shape = next((one for one in _SHAPES if one.fullmatch(first)), None)
    if shape is None:
        return None
    matches = [None if cell is None else shape.fullmatch(cell.strip()) for cell in cells]
    if any(match is None and cell is not None for match, cell in zip(matches, cells, strict=True)):
        return None
    parts = [None if match is None else match.groupdict() for match in matches]
    if len({one["any"] for one in parts if one is not None and "any" in one}) > 1:
        return None
    given = np.array([one is not None for one in parts])
    try:
        days = np.array([_day(one) for one in parts if one is not None])
    except ValueError:  # no such day
        return None
    seconds = np.array([_of_the_day(one) for one in parts if one is not None])
    if "Y" not in shape.groupindex:
        days = np.cumsum(np.diff(seconds, prepend=seconds[0]) < -DAY / 2)
    found = np.full(len(cells), np.nan)
    found[given] = DAY * (days - days[0]) + (seconds - seconds[0])
    return found


def _day(parts: dict[str, str | None]) -> int:
    """The day of one stamp, counted from year 1; 0 where it has no date that is read."""
    return date(*(int(parts[key] or 0) for key in "YMD")).toordinal() if parts.get("Y") else 0


def _of_the_day(parts: dict[str, str | None]) -> float:
    """Seconds since midnight, in UTC where the stamp says how far it is from it."""
    hour, minute = int(parts["h"] or 0), int(parts["m"] or 0)
    half = (parts.get("half") or "").lower()
    if half:
        hour = hour % 12 + (12 if half == "pm" else 0)
    seconds = 3600.0 * hour + 60.0 * minute + float((parts["s"] or "0").replace(",", "."))
    zone = parts.get("zone") or "Z"
    if zone != "Z":
        offset = 3600.0 * int(zone[1:3]) + 60.0 * int(zone[-2:])
        seconds -= offset if zone[0] == "+" else -offset
    return seconds
