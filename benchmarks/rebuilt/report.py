"""The page of the rebuilt rows: the bars, what became of each row, every answer."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from statistics import median

from benchmarks.answers import Line
from benchmarks.bars import Bar, bars_table, counts
from benchmarks.rebuilt.scoring import COUNTED, Round, asked, rounds
from hybridid.quantities import NONE, number, percent
from pipelines.shared.page import Page, Section, Table

RULES = (
    "All data are simulated. The truth is integrated by other code than the trace's.",
    "Right: the truth is first, or in a first class of at most three. Wrong: some class is not right "
    "although something is missing. All clear: nothing_missing with an error above three times the sensor's "
    "noise. Good: neither wrong nor all clear. Speaks: nothing is missing, and the verdict is not "
    "nothing_missing.",
)


def write_report(lines: Sequence[Line], folder: Path) -> str:
    """Write ``index.html``, ``index.md`` and ``rebuilt.json``; returns what to print."""
    found = rounds(lines)
    if not found:
        return "rebuilt rows: no answer beside the oracle's yet, no page written"
    bars = asked(found)
    page = _page(found, bars).write(folder)
    data = {
        "provenance": "simulated",
        "asked": [asdict(bar) for bar in bars],
        "rows": {" ".join(name): counts(part, COUNTED) for name, part in _by_row(found).items()},
        "rounds": [{**asdict(r), "truths": sorted(r.truths), "said": r.said} for r in found],
    }
    (folder / "rebuilt.json").write_text(json.dumps(data, indent=1) + "\n", encoding="utf-8")
    return "\n".join(["rebuilt rows (simulated)", *(bar.line for bar in bars), str(page)])


def _by_row(found: Sequence[Round]) -> dict[tuple[str, str], list[Round]]:
    """The scenarios of each row, with something missing and without."""
    names = dict.fromkeys((r.row, r.category) for r in sorted(found, key=lambda r: r.key))
    return {name: [r for r in found if (r.row, r.category) == name] for name in names}


def _page(found: Sequence[Round], bars: Sequence[Bar]) -> Page:
    lead = (
        f"{len(found)} simulated experiments, drawn from a fixed seed before any trace was run on them: "
        "rows of a table of wrong verdicts, each rebuilt on a rig of its kind, with the physics or without; "
        "and planted load friction and saturation."
    )
    return Page(
        "The rebuilt rows",
        lead,
        (
            Section("The bars", RULES, (bars_table(bars),)),
            Section("By row", (), (_rows(found),)),
            Section("Every scenario", (), (_all(found),)),
        ),
        marks=("simulated",),
    )


def _rows(found: Sequence[Round]) -> Table:
    counted = (what.replace("_", " ") for what in COUNTED)
    header = ("row", "", "scenarios", *counted, "declared leaves", "CPU s")
    rows = tuple(
        (
            row.replace("_", " "),
            category,
            *map(str, counts(part, COUNTED).values()),
            number(median(r.left for r in part), 3, NONE),
            number(median(r.seconds for r in part), 3, NONE),
        )
        for (row, category), part in _by_row(found).items()
    )
    notes = (
        "declared leaves: the error of the declared model on noise-free records over the noise, median",
        "CPU s: of our trace, median",
    )
    return Table("Rows (simulated)", header, rows, notes, words=(0, 1))


def _all(found: Sequence[Round]) -> Table:
    rows = tuple(
        (
            r.key,
            number(r.left, 3, NONE),
            percent(r.gain, 0) + ("" if r.detectable or not r.hides else ", not detectable"),
            r.verdict,
            "; ".join(" / ".join(one) for one in r.classes) or "nothing",
            number(r.over_noise, 3, NONE),
            number(r.times, 3, NONE),
            r.said,
        )
        for r in sorted(found, key=lambda r: r.key)
    )
    header = (
        "scenario", "declared leaves", "oracle takes", "verdict", "named (class; class)", "error over noise",
        "times, as told", "score",
    )  # fmt: skip
    return Table("Answers (simulated)", header, rows, words=(0, 2, 3, 4, 7))
