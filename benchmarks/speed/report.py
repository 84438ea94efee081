"""The page of the benchmark: a table for each part, a plot of the fits, the machine and the versions."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path

from benchmarks.speed.fits import BESIDE, GROWING
from benchmarks.speed.machine import machine
from benchmarks.speed.row import OURS, Row
from benchmarks.speed.simulations import AT_ONCE
from hybridid.plotting.looks import BLUE, VERMILION
from hybridid.plotting.style import DOUBLE_COLUMN, Plot, context, new_figure, save
from hybridid.quantities import NONE, number
from hybridid.simulation.compiler import widest
from pipelines.shared.page import Page, Picture, Section, Table

WORDS = ("what", "way", "reached", "data")
RULES = (
    "Wall seconds, medians over the repeats. Ways to one result take turns, each in a process of its own, "
    "after one call that is not timed; what would take minutes is timed once, without such a call.",
    "Every row says what it reached: ways that stop early, or elsewhere, are not faster.",
    f"What the arithmetic needs is an assumption: the operations of one step, {widest()} horizons in a "
    f"register, {AT_ONCE} instructions begun in each cycle of the fastest core, and memory free of charge.",
)


def write_report(rows: Sequence[Row], folder: Path) -> str:
    """Write ``index.html``, ``index.md``, a figure for each part with fits, and ``speed.json``; returns what
    to print."""
    folder.mkdir(parents=True, exist_ok=True)
    where = machine()
    data = {"machine": where, "rows": [{**asdict(row), "median": row.median} for row in rows]}
    (folder / "speed.json").write_text(json.dumps(data, indent=1) + "\n", encoding="utf-8")
    parts = list(dict.fromkeys(row.part for row in rows))
    sections = [
        Section(part[0].upper() + part[1:], (), (_table(part, rows),), _pictures(part, rows, folder))
        for part in parts
    ]
    told = ", ".join(
        f"{key} {number(value, 3) if isinstance(value, float) else value}" for key, value in where.items()
    )
    lead = f"How fast, beside other ways to the same result. {told}."
    marks = tuple(sorted({word for row in rows for word in row.provenance.split(" and ") if word != "none"}))
    page = Page("Speed", lead, (Section("How it was timed", RULES), *sections), marks)
    return "\n".join([*(_line(row, rows) for row in rows), str(page.write(folder))])


def _table(part: str, rows: Sequence[Row]) -> Table:
    """Of the rows of a part, without the columns that none of them fills."""
    own = [row for row in rows if row.part == part]
    columns = {
        "what": [row.what for row in own],
        "way": [row.way for row in own],
        "median [s]": [number(row.median, 3, NONE) for row in own],
        "times ours": ["" if row.way == OURS else number(_ratio(row, own), 3, NONE) for row in own],
        "peak [MB]": [number(row.memory, 3, NONE) for row in own],
        "arithmetic needs [s]": [number(row.least, 3, NONE) for row in own],
        "reached": [row.reached for row in own],
        "data": [row.provenance for row in own],
    }
    filled = {name: cells for name, cells in columns.items() if set(cells) - {NONE, ""}}
    notes = tuple(
        f"{row.what}: " + ", ".join(f"{name} {number(value, 3)}" for name, value in row.details.items())
        for row in own
        if row.details
    )
    words = tuple(k for k, name in enumerate(filled) if name in WORDS)
    return Table("Wall seconds", tuple(filled), tuple(zip(*filled.values(), strict=True)), notes, words)


def _ratio(row: Row, rows: Sequence[Row]) -> float:
    """How many times our seconds a way takes; nan without ours."""
    ours = [one.median for one in rows if (one.what, one.way) == (row.what, OURS)]
    return row.median / ours[0] if ours else float("nan")


def _line(row: Row, rows: Sequence[Row]) -> str:
    beside = "" if row.way == OURS else f", {number(_ratio(row, rows), 3, NONE)} times ours"
    return f"{row.what}, {row.way}: {number(row.median, 3, NONE)} s{beside} ({row.reached}; {row.provenance})"


def _pictures(part: str, rows: Sequence[Row], folder: Path) -> tuple[Picture, ...]:
    own = [row for row in rows if row.part == part]
    if part not in (BESIDE, GROWING):
        return ()
    name = part.replace(" ", "_").replace("-", "_")
    provenance = "measured" if {row.provenance for row in own} == {"measured"} else "simulated"
    with context():
        figure = new_figure(DOUBLE_COLUMN, 18 + 6 * len(own), part, provenance)
        axes = figure.subplots()
        for k, row in enumerate(own):
            axes.plot(row.seconds, [k] * len(row.seconds), "|", color="black")
            axes.plot(row.median, k, "o", color=BLUE if row.way == OURS else VERMILION)
        axes.set_yticks(range(len(own)), [f"{row.what}: {row.way}" for row in own])
        axes.invert_yaxis()
        axes.set_xscale("log")
        axes.set_xlabel("wall time [s]")
        caption = f"Wall seconds of each way ({provenance}); a dot is the median, a mark one repeat."
        save(Plot(figure, name, caption, provenance), folder, kinds=("svg",))
    return (Picture(folder / f"{name}.svg", caption),)
