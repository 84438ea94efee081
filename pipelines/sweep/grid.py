"""The grid of a sweep: seeds gathered into cells, and of each output the network to keep.

Errors are compared only where they are of the same blocks of the same records: cells are grouped by that
and by output. Validation records take no part in the choice.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from statistics import fmean, stdev
from typing import Any

from hybridid.residuals.choice import RULE as SIZE_THEN_SEED
from hybridid.residuals.choice import chosen_by_size, smallest_within
from hybridid.residuals.held_out import RULE as FEWEST_NODES
from pipelines.sweep.point import SEEDS, Point, spelt
from pipelines.sweep.rows import Row, rows_of

RULES: Mapping[str | None, str] = {
    "narx": SIZE_THEN_SEED,
    "rbf": FEWEST_NODES,
    None: "none: the fit of a gray box holds nothing out, so nothing is chosen; compare the records' scores",
}
"""How the network of each output is chosen, by the kind of network."""


@dataclass(frozen=True)
class Spread:
    """Mean and standard deviation of a number over seeds; ``lost`` seeds have none."""

    mean: float | None
    deviation: float | None
    lost: int = field(metadata={"key": "ran_away"})

    @classmethod
    def of(cls, values: Iterable[float | None]) -> Spread:
        """Mean and deviation of the finite values."""
        given = list(values)
        found = [value for value in given if value is not None and math.isfinite(value)]
        return cls(
            fmean(found) if found else None, stdev(found) if len(found) > 1 else None, len(given) - len(found)
        )


@dataclass(frozen=True, eq=False)
class Cell:
    """The rows of one output that differ in their seed alone; ``at`` are the coordinates that vary."""

    at: Mapping[str, Any]
    rows: tuple[Row, ...]

    @property
    def held_out(self) -> Spread:
        """RMSE on the held-out blocks."""
        return Spread.of(row.held_out for row in self.rows)

    def on(self, record: str) -> Spread:
        """RMSE on a record, in free run."""
        return Spread.of(s.rmse for row in self.rows for s in row.scores if s.record == record)


@dataclass(frozen=True, eq=False)
class Group:
    """One output judged on the same blocks, in every cell; ``chosen`` None where nothing is held out."""

    title: str
    cells: tuple[Cell, ...]
    chosen: Row | None
    rule: str

    @property
    def one(self) -> Row:
        """Any of its rows: for what all have alike."""
        return self.cells[0].rows[0]

    @property
    def provenance(self) -> str:
        """``measured``, ``simulated``, or both."""
        words = {word for cell in self.cells for row in cell.rows for word in row.provenance.split(" and ")}
        return " and ".join(sorted(words))

    @property
    def without(self) -> list[float]:
        """The gray boxes' RMSE on the held-out blocks, one for each that differs."""
        return sorted({row.without for cell in self.cells for row in cell.rows if row.without is not None})

    @property
    def records(self) -> list[tuple[str, bool]]:
        """Name of each record scored, and whether it was fitted."""
        return list(dict.fromkeys((s.record, s.fitted) for c in self.cells for r in c.rows for s in r.scores))


def groups_of(points: Sequence[Point], axes: Sequence[str]) -> list[Group]:
    """The results of finished points, over all ``axes`` of their sweep."""
    rows = [row for point in points for row in rows_of(point)]
    several = len({row.point.judged_on for row in rows}) > 1
    found: dict[tuple[str, str], list[Row]] = {}
    for row in rows:
        found.setdefault((row.point.judged_on, row.output), []).append(row)
    return [_group(own, axes, several) for own in found.values()]


def _group(rows: Sequence[Row], axes: Sequence[str], several: bool) -> Group:
    cells: dict[str, list[Row]] = {}
    for row in rows:
        cells.setdefault(spelt(_at(row, axes)), []).append(row)
    first = rows[0].point
    title = f"{first.settings.case}, {rows[0].output}" if several else rows[0].output
    made = tuple(Cell(_at(own[0], axes), tuple(own)) for own in cells.values())
    return Group(title, made, chosen_of(made), RULES[first.kind])


def _at(row: Row, axes: Sequence[str]) -> dict[str, Any]:
    return {key: row.point.at.get(key) for key in axes if key != SEEDS}


def chosen_of(cells: Sequence[Cell]) -> Row | None:
    """The network to keep by ``RULES``; None if nothing was held out, every one diverged, or the rule prefers
    no network."""
    rows = [row for cell in cells for row in cell.rows]
    if rows[0].point.kind == "narx":
        errors = [[math.inf if r.held_out is None else r.held_out for r in cell.rows] for cell in cells]
        without = math.inf if rows[0].without is None else rows[0].without
        found = chosen_by_size(errors, [cell.rows[0].size for cell in cells], without)
        return None if found is None else cells[found[0]].rows[found[1]]
    judged = [(row, row.merit, row.near) for row in rows if row.merit is not None and row.near is not None]
    if not judged:
        return None
    _, _, limit = min(judged, key=lambda one: one[1])
    return judged[smallest_within([m for _, m, _ in judged], [r.size for r, _, _ in judged], limit)][0]
