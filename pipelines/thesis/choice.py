"""The network that our rule chose without the validation record, beside the one that the thesis chose."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence

from hybridid.hybrid.report import CandidateScore, NARXReport, RBFReport
from hybridid.quantities import quantity
from pipelines.shared.hybrids import residual_of
from pipelines.thesis import chapter4, chapter5, chapter6
from pipelines.thesis.look_up import Missing, Outcomes, tree_of
from pipelines.thesis.reference import NetworkOf, Printed, ScoreTable


def choices(chapter: int, outcomes: Outcomes) -> tuple[str, ...]:
    """Sentences on how the networks of a chapter were chosen, from the results."""
    return tuple(_MAKERS[chapter](outcomes))


def _vehicle(outcomes: Outcomes) -> Iterator[str]:
    """The network of each output: by our rule, and by the thesis' error."""
    report = _report(chapter4.EXPERIMENT, outcomes)
    if not isinstance(report, NARXReport):
        return
    for table in chapter4.TABLES:
        if not isinstance(table, ScoreTable):
            continue
        grid = _grid(table)
        if grid:
            depth, width = min(grid, key=lambda size: grid[size].error)
            yield (
                f"Table {table.number}: chosen here {_chosen(report, table.rows[0].ours.output)}; the thesis "
                f"chose {depth} × {width} by the error on the training record."
            )
    yield f"Our rule uses the identification record alone: {report.rule}."


def _grid(table: ScoreTable) -> dict[tuple[int, int], Printed]:
    """The thesis' numbers by depth and width."""
    return {
        (row.ours.depth, row.ours.width): row.thesis
        for row in table.rows
        if isinstance(row.ours, NetworkOf) and row.thesis is not None
    }


def _esea(outcomes: Outcomes) -> Iterator[str]:
    """The network of each friction."""
    reports = {name: _report(experiment, outcomes) for name, experiment in chapter5.FRICTIONS.items()}
    there = {name: report for name, report in reports.items() if isinstance(report, NARXReport)}
    if there:
        listed = ", ".join(f"{name} {_chosen(report, chapter5.OUTPUT)}" for name, report in there.items())
        rule = next(iter(there.values())).rule
        yield (
            f"Networks chosen here, hidden layers × neurons: {listed}; on the identification record alone, "
            f"by the rule: {rule}. The thesis chose 4 × 256 for every friction, by R²."
        )


def _emps(outcomes: Outcomes) -> Iterator[str]:
    """The number of nodes that held-out blocks of the identification record choose."""
    report = _report(chapter6.CHOSEN, outcomes)
    if isinstance(report, RBFReport):
        rows = sorted(report.candidates, key=lambda row: row.nodes)
        scored = ", ".join(f"{row.nodes} nodes {_blocks(row.rmse, row)}" for row in rows)
        yield (
            f"Nodes chosen without the validation record: {report.nodes}, by the rule: {report.rule}. "
            f"RMSE on those blocks: gray box {_blocks(rows[0].gray_rmse, rows[0])}, {scored}."
        )


def _blocks(rmse: Sequence[float], row: CandidateScore) -> str:
    """The error on held-out blocks; a candidate that failed on one has none."""
    (value,), (unit,) = rmse, row.units
    if not math.isfinite(value):
        return f"failed ({'; '.join(row.failures)})"
    return quantity(value, unit, 3)


def _chosen(report: NARXReport, output: str) -> str:
    kept = [row for row in report.networks if row.output == output and row.chosen]
    return f"{kept[0].depth} × {kept[0].width}" if kept else "none"


def _report(experiment: str, outcomes: Outcomes) -> NARXReport | RBFReport | None:
    try:
        return residual_of(tree_of(experiment, outcomes)).report
    except Missing:
        return None


_MAKERS: Mapping[int, Callable[[Outcomes], Iterator[str]]] = {4: _vehicle, 5: _esea, 6: _emps}
