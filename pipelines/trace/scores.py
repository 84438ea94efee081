"""Before and after: what the models score on each record, as tables of the report."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace

import numpy as np

from hybridid.naming import listed
from hybridid.quantities import change, mean_square, quantity, r_squared
from hybridid.trace.results.before_after import ScoreRow
from hybridid.trace.results.result import Trace
from pipelines.shared.page import Table

_NETWORK = (
    "The network was trained on the fitted horizons only. Beside each model the strongest one is taken: "
    "beside the declared and the last one these may be different networks."
)
MANY = 3
"""Records from which their means come first and each of them is folded away."""


def score_tables(found: Trace) -> tuple[Table, ...]:
    """For each output the error of every model: on each record, and if there are many, their means first."""
    rows = [*found.before, *(found.after if found.accepted else ())]
    tables = [table for output in found.noise_floor for table in _of_output(output, rows, found)]
    notes = (
        f"Effects declared: {listed(found.declared or ['none'])}; added: "
        f"{listed([entry.name for entry in found.accepted] or ['none'])}. "
        f"Each with every parameter refitted over horizons of {found.horizon:g} s of "
        f"{listed(found.fitted_records)}.",
        *((_NETWORK,) if found.completeness else ()),
    )
    return (*tables[:-1], replace(tables[-1], notes=notes))


def _of_output(output: str, rows: Sequence[ScoreRow], found: Trace) -> Iterator[Table]:
    own = [row for row in rows if row.output == output]
    many = len({row.record for row in own}) > MANY
    of = f"Error of {output} before and after ({found.provenance})"
    if many:
        yield _means(f"{of}, mean over records", own)
    yield _each(f"{of}, record by record" if many else of, own, many)


def _means(caption: str, rows: Sequence[ScoreRow]) -> Table:
    header = ("records", "view", "model", "mean RMSE", "change", "lower in", "mean R²")
    cells = []
    for group in _grouped(rows, lambda row: (row.role, row.horizon)):
        first, *others = _grouped(group, lambda row: row.model)
        where = (f"{len(first)} {first[0].role}", _view(first[0]))
        cells.append((*where, first[0].model, _rmse(first), "", "", _r2(first)))
        for same in others:
            lower = sum(row.rmse < base.rmse for row, base in zip(same, first, strict=True))
            change_ = change(_mean(first, "rmse"), _mean(same, "rmse"))
            cells.append(("", "", same[0].model, _rmse(same), change_, f"{lower} of {len(same)}", _r2(same)))
    return Table(caption, header, tuple(cells), words=(0, 1, 2))


def _each(caption: str, rows: Sequence[ScoreRow], folded: bool) -> Table:
    """A row for each model, grouped by record and view; with what its data are, where records differ."""
    mixed = len({row.provenance for row in rows}) > 1
    measures = ("RMSE", "change", "MAE", "MSE", "R²")
    header = ("record", "", "view", "model", *measures, *(("data",) if mixed else ()))
    cells = []
    for group in _grouped(rows, lambda row: (row.record, row.role, row.horizon)):
        for row in group:
            leading = row is group[0]
            cells.append(
                (
                    *((row.record, row.role, _view(row)) if leading else ("", "", "")),
                    row.model,
                    quantity(row.rmse, row.unit),
                    "" if leading else change(group[0].rmse, row.rmse),
                    quantity(row.mae, row.unit),
                    mean_square(row.mse, row.unit),
                    r_squared(row.r2),
                    *((row.provenance,) if mixed else ()),
                )
            )
    return Table(caption, header, tuple(cells), words=(0, 1, 2, 3, 9), folded=folded)


def _grouped(rows: Sequence[ScoreRow], key: Callable[[ScoreRow], object]) -> list[list[ScoreRow]]:
    """Rows of the same key together, in the order in which the keys come."""
    groups: dict[object, list[ScoreRow]] = {}
    for row in rows:
        groups.setdefault(key(row), []).append(row)
    return list(groups.values())


def _mean(rows: Sequence[ScoreRow], what: str) -> float:
    """nan if a model cannot be simulated on a record."""
    return float(np.mean([getattr(row, what) for row in rows]))


def _rmse(rows: Sequence[ScoreRow]) -> str:
    return quantity(_mean(rows, "rmse"), rows[0].unit)


def _r2(rows: Sequence[ScoreRow]) -> str:
    return r_squared(_mean(rows, "r2"))


def _view(row: ScoreRow) -> str:
    return "free run" if row.horizon is None else f"{row.horizon:g} s horizons"
