"""The results of a sweep as text for the terminal: the grid, the networks chosen, the page's path."""

from __future__ import annotations

from collections.abc import Sequence

from rich.console import RenderableType
from rich.text import Text

from hybridid_cli.tables import rendered, table
from pipelines.sweep.conduct import SweepOutcome
from pipelines.sweep.grid import Cell, Group
from pipelines.sweep.point import SEEDS, Point, axes_of
from pipelines.sweep.words import choice, gray_note, header, line, run_words

MOST = 30
"""Rows of a table on the terminal; the page has all."""
_NAMED = 5


def summary(swept: SweepOutcome, groups: Sequence[Group]) -> str:
    """Tables, choices and the page's path."""
    parts: list[RenderableType] = [part for group in groups for part in _grid(swept, group)]
    parts += [Text(f"rule of choice: {rule}") for rule in dict.fromkeys(group.rule for group in groups)]
    parts += [Text(f"chosen for {choice(group)}") for group in groups if group.chosen is not None]
    chosen = dict.fromkeys(group.chosen.point for group in groups if group.chosen is not None)
    parts += [Text(f"  {run_words(point, swept.sweep.common)}") for point in chosen]
    return rendered([*parts, *ending(swept, "points have results")])


def ending(swept: SweepOutcome, have: str) -> list[Text]:
    """How many points ``have`` an outcome, how many of them had it before this command, the page's path."""
    done, fresh = len(swept.done), len(swept.plan.fresh)
    count = f"{done} of {len(swept.sweep.points)} {have}, {fresh} of them from before"
    return [Text(f"{count}; {swept.seconds:.1f} s"), Text(f"page: {swept.sweep.folder / 'index.html'}")]


def failed(swept: SweepOutcome) -> str:
    """Which points have no result, and why."""
    by_reason: dict[str, list[Point]] = {}
    for point, reason in swept.failures.items():
        by_reason.setdefault(reason, []).append(point)
    named = [f"{_first(points)} ({reason})" for reason, points in list(by_reason.items())[:_NAMED]]
    more = len(by_reason) - len(named)
    listed = "; ".join(named) + (f"; {more} more reasons on the page" if more > 0 else "")
    return (
        f"{len(swept.failures)} of {len(swept.sweep.points)} points have no result: {listed}. "
        "Repeat the command to run them again"
    )


def _first(points: Sequence[Point]) -> str:
    """The first of points, and how many are with it."""
    others = len(points) - 1
    return (points[0].name or points[0].settings.case) + (f" and {others} more" if others else "")


def _grid(swept: SweepOutcome, group: Group) -> list[RenderableType]:
    axes = [key for key in axes_of(swept.sweep.points) if key != SEEDS]
    names = header(group, axes)
    title = f"{group.title}, RMSE running free ({group.provenance})"
    made = table(title, names, words=(*range(len(axes)), len(names) - 1))
    shown = _shown(group)
    for cell in shown:
        made.add_row(*line(cell, group, axes))
    parts: list[RenderableType] = [made]
    left_out = len(group.cells) - len(shown)
    if left_out:
        parts.append(Text(f"the {MOST} with the lowest held-out error; {left_out} more on the page"))
    return parts + [Text(note) for note in filter(None, (gray_note(group),))]


def _shown(group: Group) -> Sequence[Cell]:
    """All cells, or of many the best, in the grid's order."""
    if len(group.cells) <= MOST:
        return group.cells
    best = sorted(group.cells, key=_error)[:MOST]
    return [cell for cell in group.cells if cell in best]


def _error(cell: Cell) -> float:
    mean = cell.held_out.mean
    return float("inf") if mean is None else mean
