"""The thesis' tables with our columns beside its own, as text."""

from __future__ import annotations

from hybridid.quantities import NONE, estimated, fixed, number, percent, r_squared
from pipelines.shared.page import Table
from pipelines.thesis import look_up
from pipelines.thesis.look_up import FoundEstimate, FoundScore, Missing, Outcomes
from pipelines.thesis.pattern import Improved, pattern, reduction
from pipelines.thesis.reference import (
    Estimates,
    EstimateTable,
    EveryEstimate,
    Measure,
    Printed,
    Scores,
    ScoreTable,
    ThesisTable,
)

ESTIMATES = ("", "thesis", "ours", "unit", "data")
ILLEGIBLE = "not legible"
Row = tuple[str, ...]


def table_of(table: ThesisTable, outcomes: Outcomes) -> Table:
    """The thesis' table with our columns, then sentences that compare the reductions, then its errata."""
    caption = f"Table {table.number}: {table.title}"
    if isinstance(table, EstimateTable):
        rows = [row for spec in table.rows for row in _estimates(spec, outcomes)]
        return Table(caption, ESTIMATES, tuple(rows), table.care, words=(0, 4))
    name = f"{table.measure.upper()} [{table.unit}]"
    header: Row = ("", f"{name}, thesis", "ours", "R², thesis", "ours", "reduction, thesis", "ours", "data")
    found = {row.label: _found(row, outcomes) for row in table.rows}
    rows = [_scores(row, table, found) for row in table.rows]
    if all(row.thesis is None for row in table.rows):
        header, rows = ("", name, "R²", "reduction", "data"), [row[::2] + row[-1:] for row in rows]
    notes = (*_patterns(table, found), *table.care)
    return Table(caption, header, tuple(rows), notes, words=(0, len(header) - 1))


def _estimates(spec: Estimates | EveryEstimate, outcomes: Outcomes) -> list[Row]:
    if isinstance(spec, EveryEstimate):
        try:
            return [
                _estimate(f"{spec.label}: {found.name.partition('.')[2] or found.name}", ILLEGIBLE, found)
                for found in look_up.estimates(spec, outcomes)
            ]
        except Missing as missing:
            return [(spec.label, ILLEGIBLE, str(missing), "", "")]
    thesis = NONE if spec.thesis is None else number(spec.thesis, 7)
    try:
        return [_estimate(spec.label, thesis, look_up.estimate(spec.ours, outcomes))]
    except Missing as missing:
        return [(spec.label, thesis, str(missing), "", "")]


def _estimate(label: str, thesis: str, found: FoundEstimate) -> Row:
    remarks = f" ({', '.join(found.remarks)})" if found.remarks else ""
    return (label, thesis, estimated(found.value, found.std, "") + remarks, found.unit, found.provenance)


def _found(row: Scores, outcomes: Outcomes) -> FoundScore | Missing:
    try:
        return look_up.score(row.ours, outcomes)
    except Missing as missing:
        return missing


def _scores(row: Scores, table: ScoreTable, found: dict[str, FoundScore | Missing]) -> Row:
    thesis = (NONE, NONE) if row.thesis is None else (fixed(row.thesis.error, 4), fixed(row.thesis.r2, 4))
    ours = found[row.label]
    printed = _percent(_thesis_reduction(row, table))
    if isinstance(ours, Missing):
        return (row.label, thesis[0], str(ours), thesis[1], NONE, printed, NONE, "")
    label = f"{row.label} (chosen)" if ours.chosen else row.label
    error = number(_error(ours, table.measure) * table.factor)
    of_ours = _percent(_our_reduction(row, table.measure, found))
    return (label, thesis[0], error, thesis[1], r_squared(ours.r2), printed, of_ours, ours.provenance)


def _percent(reduction_in_percent: float | None) -> str:
    return NONE if reduction_in_percent is None else percent(reduction_in_percent / 100, 1)


def _thesis_reduction(row: Scores, table: ScoreTable) -> float | None:
    """The reduction in % as the thesis printed it, else computed from its errors."""
    against = next((other.thesis for other in table.rows if other.label == row.against), None)
    if not isinstance(row.thesis, Printed) or against is None:
        return None
    if row.thesis.reduction is not None:
        return row.thesis.reduction
    return reduction(against.error, row.thesis.error)


def _our_reduction(row: Scores, measure: Measure, found: dict[str, FoundScore | Missing]) -> float | None:
    ours, against = found[row.label], found.get(row.against)
    if not isinstance(ours, FoundScore) or not isinstance(against, FoundScore):
        return None
    return reduction(_error(against, measure), _error(ours, measure))


def _patterns(table: ScoreTable, found: dict[str, FoundScore | Missing]) -> tuple[str, ...]:
    """Sentences that compare the rows' reductions. If rows have different gray boxes, each is called by the
    name of its own."""
    several = len({row.against for row in table.rows if row.thesis is not None and row.against}) > 1
    improved: list[Improved] = []
    for row in table.rows:
        thesis, ours = _thesis_reduction(row, table), _our_reduction(row, table.measure, found)
        if row.thesis is not None and thesis is not None and ours is not None:
            improved.append(Improved(row.against if several else row.label, thesis, ours))
    data = sorted({f.provenance for f in found.values() if isinstance(f, FoundScore)})
    return pattern(improved, " and ".join(data))


def _error(found: FoundScore, measure: Measure) -> float:
    return found.mse if measure == "mse" else found.rmse
