"""Our results beside the thesis': looks each number up in the run trees."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from pipelines.findings import estimate_of, metric_rows, prepared_records
from pipelines.page import Table
from pipelines.thesis.reference import Entry, MetricOf, ParameterOf, ThesisTable

HEADER = ("", "thesis", "ours", "unit", "data")


@dataclass(frozen=True)
class Found:
    """Our number, its standard error where it has one, and whether its data are measured."""

    value: float
    std: float | None
    provenance: str


def table_of(table: ThesisTable, trees: Mapping[str, Path]) -> Table:
    """The thesis' table with our column, as text."""
    rows = tuple(_row(entry, look_up(entry.ours, trees)) for entry in table.entries)
    return Table(f"Table {table.number}: {table.title}", HEADER, rows, table.care)


def look_up(where: ParameterOf | MetricOf, trees: Mapping[str, Path]) -> Found | None:
    """Our number, or None where the experiment's records leave it out."""
    tree = trees[where.experiment]
    if isinstance(where, ParameterOf):
        estimate = estimate_of(tree)
        row = estimate["parameters"][where.name]
        return Found(float(row["value"]), row["std"], str(estimate["provenance"]))
    names = {record.name for record in prepared_records(tree) if record.role == where.role}
    for row in metric_rows(tree):
        if row["record"] in names and (row["output"], row["view"]) == (where.output, where.view):
            value = row[where.quantity]
            return None if value is None else Found(float(value), None, str(row["provenance"]))
    return None


def _row(entry: Entry, found: Found | None) -> tuple[str, ...]:
    thesis = "" if entry.thesis is None else f"{entry.thesis:.5g}"
    if found is None:
        return (entry.label, thesis, "no such record", entry.unit, "")
    ours = f"{found.value:.5g}" + ("" if found.std is None else f" ± {1.96 * found.std:.2g}")
    return (entry.label, thesis, ours, entry.unit, found.provenance)
