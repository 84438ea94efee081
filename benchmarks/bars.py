"""``Bar``: one line of what a study must show, with what came out; and how studies count and print."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from pipelines.shared.page import Table

WORDS = {True: "holds", False: "MISSED", None: "no scenario"}


@dataclass(frozen=True)
class Bar:
    """What is asked, what came out, and whether it holds; None: neither way, for there is no scenario."""

    what: str
    found: str
    holds: bool | None

    @property
    def line(self) -> str:
        """For the terminal."""
        return f"  {WORDS[self.holds]:11} {self.what}: {self.found}"


def least(what: str, hits: Sequence[bool], share: float) -> Bar:
    """At least a ``share`` of the scenarios must be hits."""
    count = sum(hits)
    return Bar(what, f"{count} of {len(hits)}", count >= share * len(hits) if hits else None)


def most(what: str, hits: Sequence[bool], share: float) -> Bar:
    """At most a ``share`` of the scenarios may be hits."""
    count = sum(hits)
    return Bar(what, f"{count} of {len(hits)}", count <= share * len(hits) if hits else None)


def bars_table(bars: Sequence[Bar], caption: str = "Bars (simulated)") -> Table:
    """The bars as a table of a page."""
    rows = tuple((bar.what, bar.found, WORDS[bar.holds]) for bar in bars)
    return Table(caption, ("asked", "found", ""), rows, words=(0, 1, 2))


def counts(part: Sequence[object], counted: Sequence[str]) -> dict[str, int]:
    """How many scenarios there are, and of how many each word holds: the names of properties."""
    return {"scenarios": len(part), **{word: sum(getattr(r, word) for r in part) for word in counted}}


def in_words(one: object, counted: Sequence[str]) -> str:
    """Which of these words hold of a scenario."""
    return ", ".join(word.replace("_", " ") for word in counted if getattr(one, word))
