"""What came of the study in Markdown: the bars, the counts of each kind of scenario, every answer."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from statistics import median

from benchmarks.answers import Line
from benchmarks.bars import WORDS
from benchmarks.declarations.draw import CATEGORIES
from benchmarks.declarations.scoring import COUNTED, Class, Round, asked, rounds
from benchmarks.studies import table
from hybridid.naming import listed

TITLES = {
    "friction": "viscous friction declared, Coulomb friction and drag true",
    "spring": "a spring declared, none there",
    "sound_friction": "sound: the friction is true",
    "sound_spring": "sound: the spring is true",
}


def write_report(lines: Sequence[Line], out: Path) -> str:
    """Write ``report.md`` into ``out``; returns it."""
    text = report(lines)
    (out / "report.md").write_text(text, encoding="utf-8")
    return text


def report(lines: Sequence[Line]) -> str:
    """The bars, the counts, then every scenario. All are simulated."""
    found = sorted(rounds(lines), key=lambda r: r.key)
    cells = [(bar.what, bar.found, WORDS[bar.holds]) for bar in asked(found)]
    bars = table(("asked (simulated)", "found", ""), cells)
    head = ("", "of which", "not detectable", *COUNTED, "CPU s, median")
    parts = {c: [r for r in found if r.category == c] for c in CATEGORIES}
    counts = table(head, [_counts(TITLES[c], part) for c, part in parts.items() if part])
    return "\n".join([*bars, "", *counts, "", *map(_told, found)]) + "\n"


def _counts(title: str, part: Sequence[Round]) -> tuple[object, ...]:
    hidden = sum(r.detectable is False for r in part)
    said = (sum(getattr(r, word) for r in part) for word in COUNTED)
    return (title, len(part), hidden, *said, f"{median(r.seconds for r in part):.0f}")


def _told(r: Round) -> str:
    seen = {None: "", True: f" oracle {r.gain:.0%},", False: f" oracle {r.gain:.0%} (not detectable),"}
    said = [f"{one.left_out} → {_named(one.classes)} ({one.gained})" for one in r.replaced]
    parts = [
        f"{r.verdict}: {_named(r.classes)}",
        f"ends at zero: {listed(list(r.idle))}" if r.idle else "",
        f"replaced: {', '.join(said)}" if said else "",
    ]
    scored = r.said or "left in peace"
    return (
        f"- {r.key}:{seen[r.detectable]} {'; '.join(filter(None, parts))}. **{scored}** ({r.seconds:.0f} s)"
    )


def _named(classes: Sequence[Class]) -> str:
    return " + ".join(" / ".join(one) for one in classes) or "nothing"
