"""``sweep.json`` and ``plan.json``: what a sweep did and found, as data."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pipelines.sweep.conduct import SweepOutcome
from pipelines.sweep.grid import Cell, Group, Spread
from pipelines.sweep.plan import PlannedWork
from pipelines.sweep.point import Point, axes_of

Coordinates = Mapping[str, Any]
"""Values by config key."""


@dataclass(frozen=True)
class ChosenPoint:
    """The point kept for an output: its coordinates ``at``, its run ``tree`` seen from this file,
    its ``size`` in weights or nodes, and its RMSE on the held-out blocks."""

    at: Coordinates
    tree: str
    size: int
    held_out: float | None


@dataclass(frozen=True)
class CellScores:
    """The points that differ in their seed alone: RMSE on the held-out blocks and on each record."""

    at: Coordinates
    size: int
    held_out: Spread
    records: Mapping[str, Spread]


@dataclass(frozen=True)
class OutputScores:
    """One output in every cell, judged on the same blocks, in its ``unit``.

    ``gray_held_out`` are the RMSE of the gray boxes on these blocks; ``chosen`` by the ``rule``, None where
    nothing is held out.
    """

    title: str
    output: str
    unit: str
    provenance: str
    rule: str
    gray_held_out: tuple[float, ...]
    chosen: ChosenPoint | None
    cells: tuple[CellScores, ...]


@dataclass(frozen=True)
class FailedPoint:
    """A point without a result, and why."""

    at: Coordinates
    tree: str
    reason: str


@dataclass(frozen=True)
class SweepResult:
    """A sweep called ``name`` over ``axes``, asked for by ``words``; ``digest`` tells it from others."""

    name: str
    digest: str
    words: tuple[str, ...]
    seconds: float
    axes: tuple[str, ...]
    plan: PlannedWork
    outputs: tuple[OutputScores, ...]
    failures: tuple[FailedPoint, ...]


def result_of(swept: SweepOutcome, groups: Sequence[Group]) -> SweepResult:
    """All that ``sweep.json`` says."""
    sweep = swept.sweep
    return SweepResult(
        name=sweep.name,
        digest=sweep.key,
        words=tuple(sweep.words),
        seconds=swept.seconds,
        axes=tuple(axes_of(sweep.points)),
        plan=swept.plan.described,
        outputs=tuple(_output(group, sweep.folder) for group in groups),
        failures=failed_points(swept),
    )


def failed_points(swept: SweepOutcome) -> tuple[FailedPoint, ...]:
    """Those without a result."""
    return tuple(
        FailedPoint(dict(point.at), place_of(point, swept.sweep.folder), reason)
        for point, reason in swept.failures.items()
    )


def place_of(point: Point, folder: Path) -> str:
    """The point's run tree, seen from ``folder``."""
    return Path(os.path.relpath(point.tree, folder)).as_posix()


def _output(group: Group, folder: Path) -> OutputScores:
    row = group.chosen
    return OutputScores(
        title=group.title,
        output=group.one.output,
        unit=group.one.unit,
        provenance=group.provenance,
        rule=group.rule,
        gray_held_out=tuple(group.without),
        chosen=None
        if row is None
        else ChosenPoint(dict(row.point.at), place_of(row.point, folder), row.size, row.held_out),
        cells=tuple(_cell(cell, group) for cell in group.cells),
    )


def _cell(cell: Cell, group: Group) -> CellScores:
    records = {name: cell.on(name) for name, _ in group.records}
    return CellScores(dict(cell.at), cell.rows[0].size, cell.held_out, records)
