"""What counts, stated before the first run.

A trace may say of a declared effect that it ends at zero (``idle``), or that others should replace it
(``trace.revise=true``). The effect is *doubted* if either is said. In its place stand the effects of the best
replacement; without a replacement, those that the trace accepted.

An effect comes with its class, those that the trace cannot tell from it. The class *holds* a truth if it
begins with the truth, or has it and at most three members. A look-alike alone (``Effect.look_alikes``) does
not count: an engineer who declares it has the wrong law.

told      the wrong effect is doubted; the effects that stand in its place hold every effect that the machine
          truly has there (Coulomb friction and quadratic drag; none where a spring is declared and there is
          none) and no other; and nothing is false
near      not told, but the wrong effect is doubted and nothing false. Each effect in its place is a truth or
          a declared look-alike of one, and every truth has its own or a look-alike. It counts for no bar
other     neither told nor near, and the wrong effect is doubted
silent    the wrong effect is not doubted: the engineer reads nothing against it
false     a declared effect that is true is doubted. On a sound declaration this is the false alarm
misnamed  a class that the trace accepted, or put in the place of an effect, holds no truth: the machine has
          nothing of it beside what is declared

``false`` and ``misnamed`` are told beside the first four, which exclude one another. The bars (issue 18):

    wrong declarations    told in at least 16 of 20
    sound declarations    false in none of 20

A few scenarios alone are held against the same shares. A wrong friction is detectable if the records can tell
the true model from the declared one (``play.consult``); the rest are in the bar, and counted apart.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from benchmarks.answers import Line, beside_oracle
from benchmarks.bars import Bar, in_words, least, most
from benchmarks.declarations.draw import COULOMB, DRAG, FRICTION, STIFFNESS, WRONG
from hybridid.effects.library import EFFECTS
from hybridid.quantities import percent

MOST_ALIKE, LEAST_TOLD = 3, 16 / 20
COUNTED = ("told", "near", "other", "silent", "false", "misnamed")
Class = tuple[str, ...]
ALIKE = {effect.id: {effect.id, *effect.look_alikes} for effect in EFFECTS}


@dataclass(frozen=True)
class Replaced:
    """A replacement as told: the classes of the effects in the place of ``left_out``. It explains the records
    better, or ``kind`` is ``as_good``: with ``fewer`` free parameters."""

    left_out: str
    classes: tuple[Class, ...]
    kind: str
    gain: float
    fewer: int

    @property
    def gained(self) -> str:
        """What it gains, in words."""
        return percent(self.gain, 0) if self.kind == "better" else f"as good, {self.fewer} parameters fewer"


@dataclass(frozen=True)
class Round:
    """One answer beside what the oracle says of its scenario.

    ``wrong`` is the declared effect that the machine has not (empty: sound), ``truths`` those that it has in
    its place. ``classes`` are those of the accepted effects. ``detectable`` is None where the oracle is not
    asked.
    """

    key: str
    category: str
    wrong: str
    truths: frozenset[str]
    detectable: bool | None
    gain: float
    verdict: str
    classes: tuple[Class, ...]
    idle: tuple[str, ...]
    replaced: tuple[Replaced, ...]
    seconds: float

    @property
    def in_place(self) -> list[tuple[Class, ...]]:
        """What stands in the place of the wrong effect, by each way that it is doubted, the best first."""
        ways = [one.classes for one in self.replaced if one.left_out == self.wrong]
        return [*ways, *([self.classes] if self.wrong in self.idle else [])]

    @property
    def told(self) -> bool:
        return not self.false and any(map(self._is_the_truth, self.in_place[:1]))

    @property
    def near(self) -> bool:
        return not (self.told or self.false) and any(map(self._is_alike, self.in_place[:1]))

    @property
    def other(self) -> bool:
        return bool(self.in_place) and not (self.told or self.near)

    @property
    def silent(self) -> bool:
        return bool(self.wrong) and not self.in_place

    @property
    def false(self) -> bool:
        doubted = {*self.idle, *(one.left_out for one in self.replaced)}
        return bool(doubted - {self.wrong})

    @property
    def misnamed(self) -> bool:
        every = [*self.classes, *(one for each in self.replaced for one in each.classes)]
        return any(not self._held(one) for one in every)

    @property
    def said(self) -> str:
        """What it comes to, in words."""
        return in_words(self, COUNTED)

    def _held(self, one: Class) -> frozenset[str]:
        """The truths that a class holds."""
        first, every = self.truths & {one[0]}, self.truths & set(one)
        return first or (every if len(one) <= MOST_ALIKE else frozenset())

    def _is_the_truth(self, classes: Sequence[Class]) -> bool:
        held = [self._held(one) for one in classes]
        return all(held) and frozenset().union(*held) == self.truths

    def _is_alike(self, classes: Sequence[Class]) -> bool:
        names = [one[0] for one in classes]
        if len(names) < len(self.truths):  # one look-alike of two truths has not told them
            return False
        resembled = [{truth for truth in self.truths if _alike(name, truth)} for name in names]
        return bool(self.truths) and all(resembled) and set().union(*resembled) == self.truths


def _alike(name: str, truth: str) -> bool:
    """Whether an effect is the truth or a look-alike that its declaration names, at the same port."""
    port, _, what = name.partition(".")
    at, _, true = truth.partition(".")
    return port == at and what in ALIKE[true]


def wrong_and_truths(category: str, port: str) -> tuple[str, frozenset[str]]:
    """The declared effect that is wrong, and those that the machine has in its place."""
    if category == FRICTION:
        return f"{port}.viscous", frozenset((f"{port}.{COULOMB}", f"{port}.{DRAG}"))
    return (f"{port}.{STIFFNESS}" if category in WRONG else ""), frozenset()


def rounds(lines: Iterable[Line]) -> list[Round]:
    """Every answer whose scenario the oracle has seen."""
    return [_round(line, told) for line, told in beside_oracle(lines)]


def _round(line: Line, told: Mapping[str, Any] | None) -> Round:
    about, answer = line["scenario"], line["answer"]
    wrong, truths = wrong_and_truths(about["category"], about["port"])
    return Round(
        key=line["key"],
        category=about["category"],
        wrong=wrong,
        truths=truths,
        detectable=None if told is None else bool(told["detectable"]),
        gain=0.0 if told is None else float(told["gain"]),
        verdict=answer["notes"]["verdict"],
        classes=_classes(answer["classes"]),
        idle=tuple(answer["idle"]),
        replaced=tuple(
            Replaced(one["left_out"], _classes(one["classes"]), one["kind"], one["gain"], one["fewer"])
            for one in answer["replaced"]
        ),
        seconds=float(answer["seconds"]),
    )


def _classes(given: Iterable[Sequence[str]]) -> tuple[Class, ...]:
    return tuple(map(tuple, given))


def asked(found: Sequence[Round]) -> list[Bar]:
    """The bars; one without scenarios holds neither way."""
    return [
        least(
            "wrong declarations: told, with what is true in their place, at least 16 of 20",
            [r.told for r in found if r.wrong],
            LEAST_TOLD,
        ),
        most(
            "sound declarations: a replacement, or a declared effect said to end at zero, none",
            [r.false for r in found if not r.wrong],
            0.0,
        ),
    ]
