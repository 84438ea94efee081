"""The thesis' own tables beside a sweep over their grid: Tables 4.4 and 4.5."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from hybridid.hybrid.report import NARXReport
from pipelines.shared.hybrids import residual_of
from pipelines.shared.page import Table
from pipelines.shared.prepared import prepared_records
from pipelines.sweep.grid import Group
from pipelines.sweep.point import SEEDS, Point, axes_of
from pipelines.thesis import chapter4
from pipelines.thesis.look_up import Networks
from pipelines.thesis.reference import NetworkOf, ScoreTable
from pipelines.thesis.tables import table_of

_GRID = {"residual.depth", "residual.width", SEEDS}


def thesis_tables(name: str, points: Sequence[Point], groups: Sequence[Group]) -> tuple[Table, ...]:
    """The tables, if the sweep called ``name`` is over their experiment and varies nothing else."""
    if name != chapter4.EXPERIMENT or not points or set(axes_of(points)) - _GRID:
        return ()
    chosen = {(g.chosen.point, g.chosen.output) for g in groups if g.chosen is not None}
    reports = [(point, residual_of(point.tree).report) for point in points]
    rows = [
        replace(row, chosen=(point, row.output) in chosen)
        for point, report in reports
        if isinstance(report, NARXReport)
        for row in report.networks
    ]
    tree, gray = points[0].tree, reports[0][1]
    if not isinstance(gray, NARXReport):
        return ()
    roles = {record.name: record.role for record in prepared_records(tree)}
    swept = Networks(rows, gray.gray, roles)
    tables = [table for table in chapter4.TABLES if isinstance(table, ScoreTable)]
    return tuple(
        table_of(table, {chapter4.EXPERIMENT: swept})
        for table in tables
        if any(isinstance(row.ours, NetworkOf) for row in table.rows)
    )
