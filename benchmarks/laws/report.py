"""What came of the study: laws proposed, how near the oracle's error, false names and proposals."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from benchmarks.answers import Line, beside_oracle
from benchmarks.studies import table
from hybridid.effects.library import EFFECTS

NEAR = 1.2
"""Times the oracle's held-out error."""


def write_report(lines: Sequence[Line], out: Path) -> str:
    """Write ``report.md`` into ``out``; returns it."""
    text = report(lines)
    (out / "report.md").write_text(text, encoding="utf-8")
    return text


def report(lines: Sequence[Line]) -> str:
    """The counts, then every scenario. All are simulated."""
    pairs = beside_oracle(lines)
    hiding = [(line, told) for line, told in pairs if line["scenario"]["wanted"]]
    seen = [(line, told) for line, told in hiding if told["detectable"]]
    proposed = [(line, told) for line, told in seen if line["answer"]["laws"]]
    empty = [line for line, _ in pairs if not line["scenario"]["wanted"]]
    rows = [
        ("an effect is hidden, and no library has it", len(hiding), ""),
        ("the oracle detects it", len(seen), ""),
        ("a law is proposed", len(proposed), "of those detected: at least 70 % asked"),
        (
            "its held-out error is at most 1.2 times the oracle's",
            sum(map(_near, proposed)),
            "of those proposed: all asked",
        ),
        (
            "the law or one alike has the form of the effect",
            sum(line["scenario"]["wanted"]["what"] in line["answer"]["forms"] for line, _ in proposed),
            "of those proposed: at least 60 % asked",
        ),
        ("a physical name is given", sum(bool(line["answer"]["names"]) for line, _ in hiding), "5 % at most"),
        (
            "of these, all names are declared look-alikes of the effect at its port, and explain as much",
            sum(map(_resembles, hiding)),
            "the records cannot tell them from the truth",
        ),
        ("nothing is hidden", len(empty), ""),
        (
            "a name or a law is given all the same",
            sum(bool(line["answer"]["named"]) for line in empty),
            "3 % at most",
        ),
    ]
    counted = table(("of the scenarios (simulated)", "number", ""), rows)
    return "\n".join([*counted, "", *map(_told, pairs)]) + "\n"


def _near(pair: tuple[Line, dict]) -> bool:
    answer, told = pair[0]["answer"], pair[1]
    return bool(answer["after"] <= NEAR * answer["before"] * (1 - told["gain"]))


def _resembles(pair: tuple[Line, dict]) -> bool:
    """Whether each name is a look-alike of the hidden effect where that acts, and the error is near."""
    line, _ = pair
    wanted, names = line["scenario"]["wanted"], [one[0] for one in line["answer"]["names"]]
    known = {effect.id: set(effect.look_alikes) for effect in EFFECTS}
    what = wanted["what"]

    def alike(name: str) -> bool:
        port, _, effect = name.rpartition(".")
        return port in wanted["ports"] and (effect in known[what] or what in known[effect])

    return bool(names) and _near(pair) and all(map(alike, names))


def _told(pair: tuple[Line, dict]) -> str:
    line, told = pair
    answer = line["answer"]
    fall = 1 - answer["after"] / answer["before"]
    named = "; ".join(answer["named"]) or "nothing"
    seen = "" if told["detectable"] else " (not detectable)"
    said = f"ours {fall:.0%}, {answer['notes']['verdict']}: {named}"
    return f"- {line['key']}: oracle {told['gain']:.0%}{seen}, {said}"
