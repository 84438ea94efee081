"""What counts, stated before the first run.

A trace answers a scenario with a verdict and, for each effect that it accepts, the class of effects that it
cannot tell apart, the accepted one first. The truths of a scenario are the effects of the library that are
the hidden law, at its port or ports: ``truths_of``. A law without any is outside the library. A law at
several ports is also the one effect at all of them (``front+rear``: trace has it since the first run).

right            the first class begins with a truth, or holds one and has at most three members
wide             the first class holds a truth, not first, and has more than three members
wrong name       some class, the first or a later one, holds no truth although something is hidden
false discovery  some class, or a law, where nothing is hidden
honest           no class, and: the verdict is ``unexplained``, ``undecided`` or ``law_proposed`` (a law is no
                 name); or nothing is hidden; or the oracle detects nothing
silent           no class, something is hidden that the oracle detects, and the verdict says nothing of it
all-clear        ``nothing_missing`` with a held-out RMSE above three times the sensor's true noise (of the
                 worst output), whatever is hidden

An answer can be right in its first class and wrong in a later one; it then counts in both.
The bars (issue 16):

    right            at least 85 % of what the oracle detects and the library holds
    wrong names      at most 5 % of the scenarios that hide something
    false discovery  at most 5 % of the scenarios that hide nothing
    all-clear        never

Outside the library no answer can be right: those scenarios are reported apart, by how many are honest.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from benchmarks.answers import Line, beside_oracle
from benchmarks.bars import Bar, in_words, least, most
from benchmarks.league.machines import CASES
from hybridid.effects.library import EFFECTS, effect_named
from hybridid.plants.plant import Plant

TRUTH_IDS: Mapping[str, tuple[str, ...]] = {
    "heating": ("warming_friction",),
    "blow_off": ("blow_off_valve",),
    "direction.velocity*modulus.load": ("load_friction",),
    "direction.velocity*linear.travel": ("warming_friction",),
    # it switches with the side that drives; the library's adds a loss of each side
    "two_sided_load_friction": (),
}
"""Ids of the library that are a hidden law under another name than its own. They count as soon as the library
has them. An id is entered here only where its equation is that very law, whatever a trace answered."""
OF_ONE_SIDE: Mapping[str, str] = {"load_friction": "two_sided_load_friction"}
"""The load of a drawn law is the drive's effort. Where a port knows the load's side as well, the library's
effect that takes both sides together is another law; that which has an amount for each is the drawn one."""
MOST_ALIKE, MOST_OVER = 3, 3.0
LAW = "law_proposed"
HONEST = ("unexplained", "undecided", LAW)
COUNTED = ("right", "wide", "wrong", "false_discovery", "honest", "silent", "all_clear")


def truths_of(
    what: str, ports: Sequence[str], library: Iterable[str] | None = None, plant: Plant | None = None
) -> frozenset[str]:
    """``port.effect`` of every effect of the library (its ids) that is the law ``what`` there.

    With ``plant``, only where the effect can act: a port that does not know its load has no load friction.
    """
    ids = {effect.id for effect in EFFECTS} if library is None else set(library)
    own = [one for one in TRUTH_IDS.get(what, (what,)) if one in ids]
    single = {
        f"{port}.{there}"
        for port in ports
        for one in own
        for there in (OF_ONE_SIDE.get(one, one) if plant and plant.port(port).load else one,)
        if there in ids and (plant is None or effect_named(there).admissible_at(plant.port(port)))
    }
    joint = {f"{'+'.join(ports)}.{one}" for one in own if all(f"{port}.{one}" in single for port in ports)}
    return frozenset(single | joint)


@dataclass(frozen=True)
class Round:
    """One answer beside what the oracle says of its scenario."""

    key: str
    machine: str
    hidden: str | None
    truths: frozenset[str]
    detectable: bool
    gain: float
    verdict: str
    classes: tuple[tuple[str, ...], ...]
    over_noise: float
    seconds: float

    @property
    def inside(self) -> bool:
        return bool(self.truths)

    @property
    def right(self) -> bool:
        first = self.classes[0] if self.classes else ()
        near = len(first) <= MOST_ALIKE and bool(self.truths & set(first))
        return bool(first) and (first[0] in self.truths or near)

    @property
    def wide(self) -> bool:
        return bool(self.classes) and not self.right and bool(self.truths & set(self.classes[0]))

    @property
    def wrong(self) -> bool:
        return self.hidden is not None and any(not self.truths & set(one) for one in self.classes)

    @property
    def false_discovery(self) -> bool:
        return self.hidden is None and (bool(self.classes) or self.verdict == LAW)

    @property
    def honest(self) -> bool:
        quiet = self.hidden is None or not self.detectable
        return not self.classes and not self.false_discovery and (self.verdict in HONEST or quiet)

    @property
    def silent(self) -> bool:
        return not self.classes and not self.honest

    @property
    def all_clear(self) -> bool:
        return self.verdict == "nothing_missing" and self.over_noise > MOST_OVER

    @property
    def said(self) -> str:
        """What it comes to, in words."""
        return in_words(self, COUNTED)


def rounds(lines: Iterable[Line]) -> list[Round]:
    """Every answer whose scenario the oracle has seen."""
    return [_round(line, told) for line, told in beside_oracle(lines)]


def _round(line: Line, told: Mapping[str, Any]) -> Round:
    about, answer = line["scenario"], line["answer"]
    wanted, notes = about["wanted"], answer["notes"]
    plant = CASES[about["machine"]].plant
    return Round(
        key=line["key"],
        machine=about["machine"],
        hidden=wanted["what"] if wanted else None,
        truths=truths_of(wanted["what"], wanted["ports"], plant=plant) if wanted else frozenset(),
        detectable=bool(told["detectable"]),
        gain=float(told["gain"]),
        verdict=notes["verdict"],
        classes=tuple(tuple(one) for one in notes["classes"]),
        over_noise=max(notes["over_noise"]),
        seconds=float(answer["seconds"]),
    )


def groups(found: Sequence[Round]) -> dict[str, list[Round]]:
    """The scenarios by what they hide: in the library or not, detectable or not, nothing."""
    hiding = [r for r in found if r.hidden is not None]
    return {
        "in the library, detectable": [r for r in hiding if r.inside and r.detectable],
        "outside, detectable": [r for r in hiding if not r.inside and r.detectable],
        "hidden, not detectable": [r for r in hiding if not r.detectable],
        "nothing hidden": [r for r in found if r.hidden is None],
    }


def named(found: Sequence[Round]) -> dict[str, list[Round]]:
    """The answers with names, by the error that is left beside them."""
    known = [r for r in found if r.classes]
    return {
        "names that leave at most three times the noise": [r for r in known if r.over_noise <= MOST_OVER],
        "names that leave more": [r for r in known if r.over_noise > MOST_OVER],
    }


def asked(found: Sequence[Round]) -> list[Bar]:
    """The bars; one without scenarios holds neither way."""
    parts = groups(found)
    inside, empty = parts["in the library, detectable"], parts["nothing hidden"]
    hiding = [r for r in found if r.hidden is not None]
    return [
        least("in the library and detectable: right, at least 85 %", [r.right for r in inside], 0.85),
        most("wrong names where something is hidden, at most 5 %", [r.wrong for r in hiding], 0.05),
        most(
            "false discoveries where nothing is hidden, at most 5 %",
            [r.false_discovery for r in empty],
            0.05,
        ),
        most("nothing_missing above three times the noise, never", [r.all_clear for r in found], 0.0),
    ]
