"""How a sweep's numbers and names read, on the page and on the terminal."""

from __future__ import annotations

from collections.abc import Sequence

from hybridid.quantities import DIVERGES, NONE, mean_and_deviation, quantity
from pipelines.shared.page import Section, Table
from pipelines.sweep.conduct import SweepOutcome
from pipelines.sweep.grid import Cell, Group, Spread
from pipelines.sweep.point import Point, spelt

_SHORT = {
    "residual.depth": "layers",
    "residual.width": "neurons a layer",
    "residual.nodes": "nodes",
    "residual.horizons": "horizon",
    "residual.seeds": "seed",
}


def axis_name(key: str) -> str:
    """A config key for an axis or a column's head."""
    return _SHORT.get(key, key.removeprefix("residual."))


def spread_of(spread: Spread, unit: str) -> str:
    """``12.3 ± 0.4 mm``, and how many seeds have no number."""
    if spread.mean is None:
        return DIVERGES if spread.lost else NONE
    lost = f" ({spread.lost} diverged)" if spread.lost else ""
    return mean_and_deviation(spread.mean, spread.deviation, unit) + lost


def header(group: Group, axes: Sequence[str]) -> list[str]:
    """Of a group's table: coordinates, complexity, held-out error, errors on the records, a remark."""
    judged = ["size", "held-out RMSE"] if group.chosen else []
    records = [f"{name}{'' if fitted else ', unseen'}" for name, fitted in group.records]
    return [*map(axis_name, axes), *judged, *records, ""]


def line(cell: Cell, group: Group, axes: Sequence[str]) -> list[str]:
    """A cell as a row of that table."""
    unit = group.one.unit
    judged = [str(cell.rows[0].size), spread_of(cell.held_out, unit)] if group.chosen else []
    records = [spread_of(cell.on(name), unit) for name, _ in group.records]
    kept = "chosen" if any(row is group.chosen for row in cell.rows) else ""
    return [*(spelt(cell.at.get(key)) for key in axes), *judged, *records, kept]


def gray_note(group: Group) -> str:
    """The RMSE of the gray box on the same blocks; empty if nothing is held out."""
    if not group.without:
        return ""
    ends = dict.fromkeys((group.without[0], group.without[-1]))
    errors = " to ".join(quantity(value, group.one.unit) for value in ends)
    return f"the gray box alone has an RMSE of {errors} on the same blocks"


def choice(group: Group) -> str:
    """What was chosen for an output, in one sentence."""
    if group.chosen is None:
        if group.without:
            return f"{group.title}: no network; none is better than the gray box on the held-out blocks"
        return f"{group.title}: nothing is held out, nothing is chosen"
    row = group.chosen
    gray = "" if row.without is None else f", the gray box {quantity(row.without, row.unit)}"
    return (
        f"{group.title}: {row.point.name} ({row.size} {counted(row.point)}), held-out RMSE "
        f"{quantity(row.held_out, row.unit)}{gray} ({group.provenance})"
    )


def failed_section(swept: SweepOutcome, caption: str) -> list[Section]:
    """The section of the page that says which points have no result, and why; none if each has one."""
    lost = tuple((point.name, reason) for point, reason in swept.failures.items())
    return [Section("Failed", (), (Table(caption, ("", ""), lost, words=(0, 1)),))] if lost else []


def counted(point: Point) -> str:
    """What its size is counted in."""
    return "nodes" if point.kind == "rbf" else "weights"


def run_words(point: Point, words: Sequence[str]) -> str:
    """The command that takes a point's result up: ``words`` are those that no point differs in."""
    kept = [word for word in words if word.partition("=")[0].lstrip("+~") not in point.at]
    said = [*kept, *(f"{key}={spelt(value)}" for key, value in point.at.items())]
    return "hybridid run " + " ".join(map(quoted, said))


def quoted(word: str) -> str:
    """A word as one types it into a shell."""
    return f"'{word}'" if set("[]{}()*, ") & set(word) else word
