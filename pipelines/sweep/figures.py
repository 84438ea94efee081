"""The heat map of each output: held-out error over two settings, a panel for each of the rest."""

from __future__ import annotations

import itertools
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from hybridid.quantities import NONE
from pipelines.shared.sections.known import unit_of
from pipelines.sweep.grid import Cell, Group, Spread
from pipelines.sweep.point import SEEDS, spelt
from pipelines.sweep.words import axis_name

if TYPE_CHECKING:
    from hybridid.plotting.heat_map import Cells

_DOWN, _ACROSS = ("residual.depth", "case", "friction"), ("residual.width", "residual.nodes")


@dataclass(frozen=True)
class _Layout:
    """Config keys: ``down`` and ``across`` a panel (empty: nothing varies there), ``beside`` over panels."""

    down: str
    across: str
    beside: tuple[str, ...]

    @classmethod
    def of(cls, axes: Sequence[str]) -> _Layout:
        rest = [key for key in axes if key != SEEDS]
        across = _taken(rest, _ACROSS, last=True)
        return cls(_taken(rest, _DOWN), across, tuple(rest))


def _taken(rest: list[str], liked: Sequence[str], last: bool = False) -> str:
    """Remove one of the keys that are left and return it: a ``liked`` one, else the first or ``last``."""
    if not rest:
        return ""
    found = next((key for key in liked if key in rest), rest[-1 if last else 0])
    rest.remove(found)
    return found


def heat_maps(groups: Sequence[Group], axes: Sequence[str], folder: Path) -> dict[str, str]:
    """Draw a map of each output into ``folder``; captions by the files' names."""
    from hybridid.plotting.heat_map import heat_map_plot  # matplotlib takes a second to import
    from hybridid.plotting.style import save

    layout = _Layout.of(axes)
    captions: dict[str, str] = {}
    for group in groups:
        panels = list(_panels(group, layout))
        if not layout.across or not panels:
            continue
        measure = _measure(group)[0]
        plot = heat_map_plot(
            panels,
            (_axis(layout.down), _values(group, layout.down)),
            (_axis(layout.across), _values(group, layout.across)),
            (measure, group.one.unit),
            f"{group.title}: {measure}",
            group.provenance,
        )
        name = "heat_map_" + re.sub(r"\W+", "_", group.title)
        save(plot, folder, name, ("svg",))
        captions[f"{name}.svg"] = f"{group.title}: {plot.caption}"
    return captions


def _axis(key: str) -> str:
    """Most settings are counts and names: they have no unit, and the axis says so."""
    return f"{axis_name(key)} [{unit_of(key) or NONE}]" if key else ""


def _panels(group: Group, layout: _Layout) -> Iterator[Cells]:
    """The panels that hold a number."""
    from hybridid.plotting.heat_map import Cells

    record = _measure(group)[1]
    rows, columns = _values(group, layout.down), _values(group, layout.across)
    for others in itertools.product(*(_values(group, key) for key in layout.beside)):
        values, spread = np.full((2, len(rows), len(columns)), np.nan)
        chosen = None
        for cell in group.cells:
            if tuple(_text(cell, key) for key in layout.beside) == others:
                at = rows.index(_text(cell, layout.down)), columns.index(_text(cell, layout.across))
                found = cell.held_out if record is None else cell.on(record)
                values[at], spread[at] = _numbers(found)
                chosen = at if any(row is group.chosen for row in cell.rows) else chosen
        if np.isfinite(values).any():
            words = zip(map(axis_name, layout.beside), others, strict=True)
            yield Cells(", ".join(f"{name} {value}" for name, value in words), values, spread, chosen)


def _measure(group: Group) -> tuple[str, str | None]:
    """What is shown: the held-out error, or where nothing is held out that on a record."""
    if group.chosen is not None:
        return "held-out RMSE", None
    record = next((name for name, fitted in group.records if not fitted), group.records[0][0])
    return f"RMSE on {record}", record


def _numbers(spread: Spread) -> tuple[float, float]:
    return (
        np.nan if spread.mean is None else spread.mean,
        np.nan if spread.deviation is None else spread.deviation,
    )


def _text(cell: Cell, key: str) -> str:
    return spelt(cell.at.get(key)) if key else ""


def _values(group: Group, key: str) -> list[str]:
    """The settings of one axis: numbers sorted, words in the order of the sweep."""
    found = {_text(cell, key): cell.at.get(key) for cell in group.cells}
    numbers = {text: float(value) for text, value in found.items() if isinstance(value, int | float)}
    return sorted(found, key=lambda text: numbers[text]) if len(numbers) == len(found) else list(found)
