"""A sweep's report: ``index.html`` and ``index.md`` to read, ``sweep.json`` and ``networks.csv`` as data."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterator, Sequence
from pathlib import Path

from pipelines.shared.page import Page, Picture, Section, Table
from pipelines.shared.storage import json_text
from pipelines.shared.tree import replacing, write_text
from pipelines.sweep.conduct import SweepOutcome
from pipelines.sweep.figures import heat_maps
from pipelines.sweep.grid import Group, groups_of
from pipelines.sweep.point import SEEDS, axes_of, spelt
from pipelines.sweep.results import place_of, result_of
from pipelines.sweep.rows import Row
from pipelines.sweep.thesis import thesis_tables
from pipelines.sweep.words import choice, failed_section, gray_note, header, line, run_words

FIGURES = "figures"


def write_report(swept: SweepOutcome) -> list[Group]:
    """Write all four files and the figures; returns what they say."""
    groups = groups_of(swept.done, axes_of(swept.sweep.points))
    folder = swept.sweep.folder
    with replacing(folder / FIGURES) as new:
        captions = heat_maps(groups, axes_of(swept.sweep.points), new)
    pictures = {name: Picture(folder / FIGURES / name, text) for name, text in captions.items()}
    page_of(swept, groups, tuple(pictures.values())).write(folder)
    write_text(folder / "networks.csv", _csv(groups, folder))
    write_text(folder / "sweep.json", json_text(result_of(swept, groups)))
    return groups


def page_of(swept: SweepOutcome, groups: Sequence[Group], pictures: tuple[Picture, ...]) -> Page:
    """The page of the sweep: what was chosen, the grid, what failed, how the work was planned."""
    sweep, axes = swept.sweep, [key for key in axes_of(swept.sweep.points) if key != SEEDS]
    tables = tuple(
        Table(
            f"{group.title} ({group.provenance})",
            tuple(header(group, axes)),
            tuple(tuple(line(cell, group, axes)) for cell in group.cells),
            notes=tuple(filter(None, (gray_note(group),))),
            words=(*range(len(axes)), len(header(group, axes)) - 1),
        )
        for group in groups
    )
    rules = tuple(dict.fromkeys(f"Rule of choice: {group.rule}." for group in groups))
    chosen = [group.chosen.point for group in groups if group.chosen is not None]
    commands = tuple(dict.fromkeys(run_words(point, sweep.common) for point in chosen))
    sections = [
        Section("Chosen", (*map(choice, groups), *rules, *_remarks(groups)), (), (), commands),
        Section("Grid", (), tables, pictures),
    ]
    compared = thesis_tables(sweep.name, swept.done, groups)
    if compared:
        sections.append(Section("Beside the thesis", (), compared))
    sections += failed_section(swept, "Points without a result")
    again = (f"hybridid sweep {' '.join(sweep.words)}",)
    sections.append(Section("Plan", tuple(swept.plan.lines), commands=again))
    provenance = sorted({word for group in groups for word in group.provenance.split(" and ")})
    lead = f"{len(swept.done)} of {len(sweep.points)} points have results."
    return Page(f"Sweep: {sweep.name}", lead, tuple(sections), tuple(provenance))


def _remarks(groups: Sequence[Group]) -> Iterator[str]:
    """What the numbers of the tables are."""
    yield "Validation records (unseen) are shown and take no part in the choice."
    if any(len(cell.rows) > 1 for group in groups for cell in group.cells):
        yield "Numbers are mean ± standard deviation over seeds."


def _csv(groups: Sequence[Group], folder: Path) -> str:
    """A row for each output of each point."""
    rows = [_flat(row, group, folder) for group in groups for cell in group.cells for row in cell.rows]
    names = list(dict.fromkeys(name for row in rows for name in row))
    text = io.StringIO()
    writer = csv.DictWriter(text, names, restval="", lineterminator="\n")
    writer.writeheader()
    writer.writerows(rows)
    return text.getvalue()


def _flat(row: Row, group: Group, folder: Path) -> dict[str, object]:
    point = row.point
    found: dict[str, object] = {"case": point.settings.case}
    found |= {key: spelt(value) for key, value in point.at.items()}
    found |= {"output": row.output, "unit": row.unit, "size": row.size, "provenance": row.provenance}
    found |= {"held_out_rmse": row.held_out, "gray_held_out_rmse": row.without}
    for score in row.scores:
        found |= {f"rmse.{score.record}": score.rmse, f"r2.{score.record}": score.r2}
    return {**found, "chosen": row is group.chosen, "tree": place_of(point, folder)}
