"""What counts, stated before the first run.

A trace answers with a verdict and, for each effect that it accepts, the class of effects that it cannot tell
apart, the accepted one first. The truths of a scenario are the names of the library's form of the hidden law
at its place, and of forms that are that very law there: ``truths_of``. A class is right if it begins with a
truth, or holds one and has at most three members.

wrong name   some class, the first or a later one, is not right although something is missing
all-clear    ``nothing_missing`` with a held-out RMSE above three times the sensor's true noise (worst output)
good         no wrong name and no all-clear: every class is right, or there is none and the verdict does not
             give the all-clear
speaks       nothing is missing, and there is a class, or a verdict other than ``nothing_missing``

The bars (issue 16). Rows of the table: something missing, at least 57 of 60 good; nothing missing, at most 2
of 60 speak. Planted load friction: at least 90 % of what the oracle detects is right (in the first class);
planted saturation alike. A few scenarios alone are held against the same shares.

``times`` is what the trace itself says of the error that is left, over what noise and simulation leave. It is
told beside; the bar is on the true noise.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from benchmarks.answers import Line, beside_oracle
from benchmarks.bars import Bar, in_words, least, most

MOST_ALIKE, MOST_OVER = 3, 3.0
LEAST_GOOD, MOST_SPEAK, LEAST_RIGHT = 57 / 60, 2 / 60, 0.9
COUNTED = ("right", "wrong", "all_clear", "good", "speaks")
AXLES = ("front_suspension", "rear_suspension", "front_suspension+rear_suspension")
TRUTHS: Mapping[str, tuple[tuple[str, ...], tuple[str, ...]]] = {
    # of what overflows the upper tank, the lower one gets a share; the library held no such effect at first
    "overflow": (("upper", "upper+lower"), ("overflow", "overflow_into")),
    # the library's bouc_wen excludes gamma + delta < 0
    "hysteresis": (("oscillator",), ("hardening_hysteresis",)),
    "friction_behind_gap": (("damper",), ("friction_behind_play",)),
    "scaled_friction": (("damper",), ("input_scaled_friction",)),
    # the one exception: the same physics, but the library has the inertia to second order in position only
    "varying_inertia": (("carriage",), ("varying_inertia",)),
    "backlash": (("carriage",), ("backlash",)),
    # a knee at zero speed is no knee: there an asymmetric damper is asymmetric viscous friction
    "dampers": (AXLES, ("asymmetric_viscous", "asymmetric_damper")),
    "load_friction@carriage": (("carriage",), ("load_friction",)),
    "load_friction@emps_rig": (("carriage",), ("load_friction",)),
    "load_friction@servo_rig": (("joint",), ("load_friction",)),
    "load_friction@esea": (("motor",), ("load_friction",)),
    "saturation@carriage": (("force",), ("input_saturation",)),
    "saturation@esea": (("torque",), ("input_saturation",)),
}
"""Places and ids of the truths of a row. An id that the library has not yet counts as soon as it has it; one
is entered only where its equation is that very law, whatever a trace answered (with one exception, above)."""


def truths_of(row: str, amounts: Mapping[str, float]) -> frozenset[str]:
    """``port.effect`` of every effect that is what a scenario of ``row`` hides; none where nothing is."""
    if not amounts:
        return frozenset()
    if row == "stiff":
        return frozenset(("damper.dahl" if amounts["form"] < 1 else "damper.bouc_wen",))
    ports, ids = TRUTHS[row]
    return frozenset(f"{port}.{one}" for port in ports for one in ids)


@dataclass(frozen=True)
class Round:
    """One answer beside what the oracle says of its scenario.

    ``left`` is what the declared model leaves of noise-free records over the noise, of the worst output.
    """

    key: str
    row: str
    machine: str
    category: str
    noise: float
    truths: frozenset[str]
    detectable: bool
    gain: float
    left: float
    verdict: str
    classes: tuple[tuple[str, ...], ...]
    over_noise: float
    times: float
    seconds: float

    def holds_truth(self, one: Sequence[str]) -> bool:
        """Whether the class ``one`` is right."""
        return one[0] in self.truths or (len(one) <= MOST_ALIKE and bool(self.truths & set(one)))

    @property
    def hides(self) -> bool:
        return self.category != "nothing"

    @property
    def right(self) -> bool:
        return bool(self.classes) and self.holds_truth(self.classes[0])

    @property
    def wrong(self) -> bool:
        return self.hides and not all(map(self.holds_truth, self.classes))

    @property
    def all_clear(self) -> bool:
        return self.verdict == "nothing_missing" and self.over_noise > MOST_OVER

    @property
    def good(self) -> bool:
        return self.hides and not self.wrong and not self.all_clear

    @property
    def speaks(self) -> bool:
        return not self.hides and (bool(self.classes) or self.verdict != "nothing_missing")

    @property
    def said(self) -> str:
        """What it comes to, in words."""
        return in_words(self, COUNTED)


def rounds(lines: Iterable[Line]) -> list[Round]:
    """Every answer whose scenario the oracle has seen."""
    return [_round(line, told) for line, told in beside_oracle(lines)]


def _round(line: Line, told: Mapping[str, Any]) -> Round:
    about, answer = line["scenario"], line["answer"]
    notes = answer["notes"]
    return Round(
        key=line["key"],
        row=about["row"],
        machine=about["machine"],
        category=about["category"],
        noise=about["noise"],
        truths=truths_of(about["row"], about["amounts"]),
        detectable=bool(told["detectable"]),
        gain=float(told["gain"]),
        left=max(told["left"]),
        verdict=notes["verdict"],
        classes=tuple(tuple(one) for one in notes["classes"]),
        over_noise=max(notes["over_noise"]),
        times=float(notes["times"]),
        seconds=float(answer["seconds"]),
    )


def asked(found: Sequence[Round]) -> list[Bar]:
    """The bars; one without scenarios holds neither way."""
    return [
        least(
            "something missing: no wrong name and no nothing_missing above three times the noise, 57 of 60",
            [r.good for r in found if r.category == "missing"],
            LEAST_GOOD,
        ),
        most(
            "nothing missing: a name, or a verdict other than nothing_missing, at most 2 of 60",
            [r.speaks for r in found if r.category == "nothing"],
            MOST_SPEAK,
        ),
        *(_planted(found, category) for category in ("load_friction", "saturation")),
    ]


def _planted(found: Sequence[Round], category: str) -> Bar:
    """Of what the oracle detects, named first or in a class of at most three."""
    what = f"planted {category.replace('_', ' ')} that the oracle detects: right, at least 90 %"
    return least(what, [r.right for r in found if r.category == category and r.detectable], LEAST_RIGHT)
