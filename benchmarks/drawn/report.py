"""The drawn league's page: the bars, what became of each kind of scenario, every answer."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from statistics import median

from benchmarks.answers import Line
from benchmarks.bars import Bar, bars_table, counts
from benchmarks.drawn.scoring import COUNTED, Round, asked, groups, named, rounds
from hybridid.quantities import NONE, number, percent
from pipelines.shared.page import Page, Section, Table


def write_report(lines: Sequence[Line], folder: Path) -> str:
    """Write ``index.html``, ``index.md`` and ``league.json``; returns what to print."""
    found = rounds(lines)
    if not found:
        return "drawn league: no answer beside the oracle's yet, no page written"
    bars, parts, names = asked(found), groups(found), named(found)
    page = _page(found, bars, parts).write(folder)
    data = {
        "provenance": "simulated",
        "asked": [asdict(bar) for bar in bars],
        "groups": {name: counts(part, COUNTED) for name, part in parts.items()},
        "named": {name: counts(part, COUNTED) for name, part in names.items()},
        "machines": {name: counts(part, COUNTED) for name, part in _by_machine(found).items()},
        "rounds": [{**asdict(r), "truths": sorted(r.truths), "said": r.said} for r in found],
    }
    (folder / "league.json").write_text(json.dumps(data, indent=1) + "\n", encoding="utf-8")
    return f"{_printed(bars, {**parts, **names})}\n{page}"


def _by_machine(found: Sequence[Round]) -> dict[str, list[Round]]:
    return {name: [r for r in found if r.machine == name] for name in sorted({r.machine for r in found})}


def _page(found: Sequence[Round], bars: Sequence[Bar], parts: dict[str, list[Round]]) -> Page:
    lead = (
        f"{len(found)} simulated experiments, drawn at random from fixed seeds before any trace was run on "
        "them, hide an effect or nothing; our trace gets two records and the declared model."
    )
    rules = (
        "All data are simulated by virtual rigs, whose truth is integrated by other code than the trace's.",
        "Right: the truth is first, or in a first class of at most three. Wrong: some class holds no truth. "
        "Honest: no name, and unexplained, undecided, or nothing to be found. An answer can be right in its "
        "first class and wrong in a later one.",
    )
    worth = [r for r in parts["in the library, detectable"] if r.gain >= 0.05]
    right = f"{sum(r.right for r in worth)} of {len(worth)}"
    told = f"In the library, detectable, and worth 5 % or more of the held-out error: right {right}."
    return Page(
        "The drawn league",
        lead,
        (
            Section("The bars", (*rules, told), (bars_table(bars),)),
            Section("By what is hidden", (), (_table("By what is hidden", parts),)),
            Section("What a name is worth", (), (_table("By the error that is left", named(found)),)),
            Section("By machine", (), (_table("By machine", _by_machine(found)),)),
            Section("Every scenario", (), (_all(found),)),
        ),
        marks=("simulated",),
    )


def _table(caption: str, parts: dict[str, list[Round]]) -> Table:
    header = ("", "scenarios", *(what.replace("_", " ") for what in COUNTED), "CPU s")
    rows = tuple(
        (name, *(str(count) for count in counts(part, COUNTED).values()), _seconds(part))
        for name, part in parts.items()
    )
    return Table(f"{caption} (simulated)", header, rows, ("CPU s: of our trace, median",))


def _seconds(part: Sequence[Round]) -> str:
    return number(median(r.seconds for r in part), 3, NONE) if part else NONE


def _all(found: Sequence[Round]) -> Table:
    rows = tuple(
        (
            r.key,
            "yes" if r.inside else "no" if r.hidden else NONE,
            percent(r.gain, 0) + ("" if r.detectable else ", not detectable"),
            r.verdict,
            "; ".join(" / ".join(one) for one in r.classes) or "nothing",
            number(r.over_noise, 3, NONE),
            r.said,
        )
        for r in sorted(found, key=lambda r: r.key)
    )
    header = (
        "scenario", "in library", "oracle takes", "verdict", "named (class; class)", "error over noise",
        "score",
    )  # fmt: skip
    return Table("Answers (simulated)", header, rows, words=(0, 1, 2, 3, 4, 6))


def _printed(bars: Sequence[Bar], parts: dict[str, list[Round]]) -> str:
    lines = ["drawn league (simulated)"]
    for name, part in parts.items():
        found = counts(part, COUNTED).items()
        said = ", ".join(f"{what.replace('_', ' ')} {n}" for what, n in found if n)
        lines.append(f"  {name}: {said or 'no scenario'}")
    return "\n".join([*lines, *(bar.line for bar in bars)])
