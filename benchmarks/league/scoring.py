"""What the league's lines come to: by player and category, and against what was asked."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from statistics import median
from typing import Any

from benchmarks.answers import Line, beside_oracle
from benchmarks.bars import Bar, least, most
from benchmarks.league.planting import Hidden
from benchmarks.league.scenario import CATEGORIES

EMPTY = ("outside", "nothing")
"""Categories where the right answer is to name nothing."""


@dataclass(frozen=True)
class Round:
    """One player before one scenario. ``detectable`` is None where nothing in the library is planted."""

    key: str
    category: str
    machine: str
    truth: str | None
    player: str
    answer: Mapping[str, Any]
    detectable: bool | None
    hidden: Sequence[Mapping[str, Any]]

    @property
    def first(self) -> str | None:
        return self.answer["named"][0] if self.answer["named"] else None

    @property
    def top(self) -> bool:
        """Named first what was planted; of an empty category: nothing."""
        return self.first is None if self.category in EMPTY else self.first == self.truth

    @property
    def covered(self) -> bool:
        """Named first, or in the class reported."""
        return self.top or (self.category not in EMPTY and self.truth in self.answer["alike"])

    @property
    def counts(self) -> bool:
        """Whether it enters the shares: an effect of the library only if the oracle can detect it."""
        return self.category in EMPTY or bool(self.detectable)

    @property
    def parameter_error(self) -> float | None:
        """Largest relative error of the named effect's values, where it is what was planted."""
        if not self.hidden or self.category == "outside" or self.first != self.truth:
            return None
        one = Hidden(self.hidden[0]["what"], self.hidden[0]["port"], self.hidden[0]["values"])
        found = self.answer["values"]
        errors = [abs(found[n] - true) / abs(true) for n, true in one.truth.items() if true and n in found]
        return max(errors, default=None)


def rounds(lines: Iterable[Line]) -> list[Round]:
    """Every answer beside what the oracle says of its scenario; what it has not seen is left out."""
    return [_round(line, told) for line, told in beside_oracle(lines)]


def _round(line: Line, told: Mapping[str, Any] | None) -> Round:
    about = line["scenario"]
    return Round(
        key=line["key"],
        category=about["category"],
        machine=about["machine"],
        truth=about["truth"],
        player=line["player"],
        answer=line["answer"],
        detectable=None if told is None else bool(told["detectable"]),
        hidden=about["hidden"],
    )


@dataclass(frozen=True)
class Tally:
    """One player in one category: counts of the scenarios that count, and medians over them."""

    scenarios: int
    top: int
    covered: int
    abstained: int
    class_size: float
    parameter_error: float
    before: float
    after: float
    seconds: float

    @classmethod
    def of(cls, part: Sequence[Round]) -> Tally:
        def middle(values: Iterable[float | None]) -> float:
            kept = [float(v) for v in values if v is not None and math.isfinite(v)]
            return median(kept) if kept else math.nan

        return cls(
            scenarios=len(part),
            top=sum(r.top for r in part),
            covered=sum(r.covered for r in part),
            abstained=sum(r.first is None for r in part),
            class_size=middle(len(r.answer["alike"]) for r in part if r.first),
            parameter_error=middle(r.parameter_error for r in part),
            before=middle(r.answer["before"] for r in part),
            after=middle(r.answer["after"] for r in part),
            seconds=middle(r.answer["seconds"] for r in part),
        )


def tallies(found: Sequence[Round]) -> dict[str, dict[str, Tally]]:
    """Category -> player -> tally, over scenarios that every player has answered and that count."""
    players = sorted({r.player for r in found})
    complete = {
        key for key in {r.key for r in found} if {r.player for r in found if r.key == key} == set(players)
    }
    counting = [r for r in found if r.counts and r.key in complete]
    return {
        category: {
            p: Tally.of([r for r in counting if r.category == category and r.player == p]) for p in players
        }
        for category in CATEGORIES
        if any(r.category == category for r in counting)
    }


def asked(found: Sequence[Round], mine: str) -> list[Bar]:
    """The league's targets, from what ``mine`` answered; a target without scenarios holds neither way."""
    own = [r for r in found if r.player == mine]
    planted = [r for r in own if r.category not in EMPTY and r.counts]
    sizes = [len(r.answer["alike"]) for r in planted if r.first]
    covered = [r.covered for r in planted]
    nothing, outside = ([r.first is not None for r in own if r.category == c] for c in ("nothing", "outside"))
    lines = [
        least("planted and detectable: named first or in the class, at least 90 %", covered, 0.9),
        Bar(
            "size of the class, at most 3 in the median",
            f"{median(sizes):g}" if sizes else "no class",
            median(sizes) <= 3 if sizes else None,
        ),
        most("false discoveries where nothing is missing, at most 5 %", nothing, 0.05),
        most("names where the effect is outside the library, at most 10 %", outside, 0.10),
    ]
    for category, by_player in tallies(found).items():
        if mine in by_player and category != "nothing" and len(by_player) > 1:
            lines.append(_against(category, by_player, mine))
    return lines


def _against(category: str, by_player: Mapping[str, Tally], mine: str) -> Bar:
    own = by_player[mine]
    others = {name: tally for name, tally in by_player.items() if name != mine}
    said = ", ".join(f"{name} {tally.covered}" for name, tally in others.items())
    found, best = f"{own.covered} of {own.scenarios}; {said}", max(t.covered for t in others.values())
    if category == "clean":
        return Bar("clean: not worse than any rival", found, own.covered >= best)
    return Bar(f"{category.replace('_', ' ')}: better than every rival", found, own.covered > best)
