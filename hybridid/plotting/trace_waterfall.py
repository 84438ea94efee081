"""Figure: the held-out error by effect, from the declared model down to the noise floor."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from matplotlib.axes import Axes

from hybridid.plotting.axes import Scale, scale_for
from hybridid.plotting.lettering import cut
from hybridid.plotting.looks import BLUE, DATA_GREY, GREEN, INK, SOFT_INK
from hybridid.plotting.series import PlotError
from hybridid.plotting.style import DOUBLE_COLUMN, Plot, new_figure, styled
from hybridid.quantities import change, quantity

ROW = 7.5  # mm
THICK = 0.62  # of a row
NAME = 46  # characters of a row's name that are printed


@dataclass(frozen=True)
class Level:
    """The RMSE after the change that ``label`` names; the first level is the declared model's."""

    label: str
    rmse: float


@styled
def waterfall_plot(
    levels: Sequence[Level],
    floor: float,
    output: str,
    unit: str,
    judged: str,
    provenance: str,
    width: float = DOUBLE_COLUMN,
) -> Plot:
    """One row for each change: the error before and after it; last, the noise ``floor`` in ``unit``.

    ``judged`` says in words over which horizons the error is computed.

    Raises:
        PlotError: if there is no level.
    """
    if not levels:
        raise PlotError("waterfall: no level to draw; give at least the declared model's")
    scale = scale_for("RMSE", unit, np.array([level.rmse for level in levels]))
    figure = new_figure(
        width, 16 + ROW * (len(levels) + 1), f"{output} error by effect, {judged}", provenance
    )
    axes = figure.subplots()
    top = max(level.rmse for level in levels) * scale.factor
    _bar(axes, 0, levels[0].rmse, scale, DATA_GREY, quantity(levels[0].rmse, unit))
    for row, (before, after) in enumerate(pairwise(levels), 1):
        _fall(axes, row, before.rmse, after.rmse, scale, unit)
    last = len(levels)
    _bar(axes, last, floor, scale, GREEN, quantity(floor, unit))
    axes.set_yticks(
        range(last + 1), [*(cut(level.label, NAME) for level in levels), "noise floor of the sensor"]
    )
    axes.set_ylim(last + 0.6, -0.6)
    axes.set_xlim(0.0, 1.22 * top or 1.0)
    axes.tick_params(axis="y", length=0)
    axes.grid(False, axis="y")
    axes.set_xlabel(f"{scale.label}; pale: what the effect takes" if len(levels) > 1 else scale.label)
    steps = ", then ".join(f"{level.label} {quantity(level.rmse, unit)}" for level in levels)
    noise = f"noise floor of the sensor {quantity(floor, unit)}"
    caption = f"RMSE of {output} ({provenance}), {judged}: {steps}; {noise}."
    return Plot(figure, f"waterfall_{output}", caption, provenance)


def _bar(axes: Axes, row: int, rmse: float, scale: Scale, colour: str, text: str, end: float = 0.0) -> None:
    """Draw an error, and print ``text`` behind it, or behind what was there before if that has its ``end``
    farther to the right."""
    left = rmse * scale.factor
    axes.barh(row, left, THICK, color=colour, edgecolor=INK, linewidth=0.4, zorder=2)
    behind = (max(left, end * scale.factor), row)
    axes.annotate(text, behind, (4, 0), textcoords="offset points", va="center", color=INK)


def _fall(axes: Axes, row: int, before: float, after: float, scale: Scale, unit: str) -> None:
    """Draw the error after a change, pale what the change took, and print both."""
    axes.barh(row, before * scale.factor, THICK, color=BLUE, alpha=0.25, linewidth=0, zorder=1)
    said = f"{quantity(after, unit)}  ({change(before, after, 0)})"
    _bar(axes, row, after, scale, BLUE, said, before)
    axes.plot(
        [before * scale.factor] * 2,
        [row - 1 + THICK / 2, row - THICK / 2],
        color=SOFT_INK,
        linewidth=0.5,
        zorder=1,
    )
