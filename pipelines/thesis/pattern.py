"""Sentences on which rows improve most, in the thesis and here; they follow from the numbers alone."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import combinations

from hybridid.quantities import percent

LISTED = 5
"""The number of rows named in order; of further rows only the count is given."""


@dataclass(frozen=True)
class Improved:
    """A row's reduction of the error in %, the thesis' and ours; negative if the error grew."""

    label: str
    thesis: float
    ours: float


def reduction(before: float, after: float) -> float:
    """``100 (1 - after / before)``: the relative reduction of the error, in %."""
    return 100.0 * (1.0 - after / before)


def pattern(rows: Sequence[Improved], provenance: str) -> tuple[str, ...]:
    """Two sentences: the rows by reduction in the thesis and here, then where they differ.

    Empty if fewer than two rows have both numbers.
    """
    if len(rows) < 2:
        return ()
    thesis, ours = _ranked(rows, lambda row: row.thesis), _ranked(rows, lambda row: row.ours)
    most = (
        f"Improve most, thesis: {_listed(thesis, lambda row: row.thesis)}. "
        f"Ours ({provenance}): {_listed(ours, lambda row: row.ours)}."
    )
    return most, f"{_order(rows, thesis, ours)} {_worse(rows)}"


def _ranked(rows: Sequence[Improved], key: Callable[[Improved], float]) -> list[Improved]:
    return sorted(rows, key=key, reverse=True)


def _listed(ranked: Sequence[Improved], key: Callable[[Improved], float]) -> str:
    shown = [f"{row.label} {percent(key(row) / 100, 1)}" for row in ranked[:LISTED]]
    rest = f", and {len(ranked) - LISTED} more" if len(ranked) > LISTED else ""
    return ", ".join(shown) + rest


def _order(rows: Sequence[Improved], thesis: list[Improved], ours: list[Improved]) -> str:
    if [row.label for row in thesis] == [row.label for row in ours]:
        return "Both orders are the same."
    pairs = list(combinations(rows, 2))
    alike = sum((a.thesis - b.thesis) * (a.ours - b.ours) > 0 for a, b in pairs)
    moved = [
        f"{row.label} is {_th(thesis.index(row))} there and {_th(ours.index(row))} here"
        for row in thesis
        if thesis.index(row) != ours.index(row)
    ]
    which = "; ".join(moved) if len(rows) <= LISTED else moved[0]
    return f"The orders differ ({alike} of {len(pairs)} pairs have the same order): {which}."


def _worse(rows: Sequence[Improved]) -> str:
    there = {row.label for row in rows if row.thesis < 0}
    here = {row.label for row in rows if row.ours < 0}
    if there == here:
        return f"Worse than their gray box, there and here: {_names(here, rows)}."
    return f"Worse than their gray box: {_names(there, rows)} in the thesis, {_names(here, rows)} here."


def _names(labels: set[str], rows: Sequence[Improved]) -> str:
    if len(labels) == len(rows):
        return f"all {len(rows)}"
    return ", ".join(row.label for row in rows if row.label in labels) or "none"


def _th(place: int) -> str:
    return {0: "1st", 1: "2nd", 2: "3rd"}.get(place, f"{place + 1}th")
