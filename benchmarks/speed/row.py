"""``Row``: what was timed, how often, and the result that it reached."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from statistics import median
from typing import Any

from benchmarks.speed.contest import Timed

OURS = "hybridid"
"""What our own way is called; the others are held against it."""


@dataclass(frozen=True)
class Row:
    """One way to one result.

    ``seconds`` are the wall seconds of each call and ``memory`` the process's peak in MB (nan: not asked).
    ``reached`` says in words what it found, so that nobody is fast and wrong. ``least`` is the time that the
    arithmetic alone needs (nan: not known). ``provenance`` is that of the data: measured, simulated or none.
    """

    part: str
    what: str
    way: str
    seconds: tuple[float, ...]
    reached: str
    provenance: str
    memory: float = float("nan")
    least: float = float("nan")
    details: dict[str, float] = field(default_factory=dict)

    @property
    def median(self) -> float:
        """Of the seconds."""
        return median(self.seconds)


def rows_of(
    part: str, what: str, found: Sequence[Timed], provenance: str, reached: Callable[[Any], str] = str
) -> list[Row]:
    """The rows of a contest; ``reached`` says in words what a way found, after the clock has stopped."""
    return [
        Row(part, what, one.name, one.seconds, reached(one.found), provenance, one.memory) for one in found
    ]
