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
from hybridid.quantities import change

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
    _bar(axes, 0, 0.0, levels[0].rmse, scale, DATA_GREY, scale.text(levels[0].rmse))
    for row, (before, after) in enumerate(pairwise(levels), 1):
        _fall(axes, row, before.rmse, after.rmse, scale)
    last = len(levels)
    _bar(axes, last, 0.0, floor, scale, GREEN, f"{scale_for('', unit, np.array([floor])).text(floor)}")
    axes.set_yticks(
        range(last + 1), [*(cut(level.label, NAME) for level in levels), "noise floor of the sensor"]
    )
    axes.set_ylim(last + 0.6, -0.6)
    axes.set_xlim(0.0, 1.22 * top or 1.0)
    axes.tick_params(axis="y", length=0)
    axes.grid(False, axis="y")
    axes.set_xlabel(scale.label)
    steps = ", then ".join(f"{level.label} {scale.text(level.rmse)}" for level in levels)
    caption = (
        f"RMSE of {output} ({provenance}), {judged}: {steps}; noise floor of the sensor {scale.text(floor)}."
    )
    return Plot(figure, f"waterfall_{output}", caption, provenance)


def _bar(axes: Axes, row: int, low: float, high: float, scale: Scale, colour: str, text: str) -> None:
    span = (high - low) * scale.factor
    axes.barh(row, span, THICK, left=low * scale.factor, color=colour, edgecolor=INK, linewidth=0.4, zorder=2)
    axes.annotate(
        text, (high * scale.factor, row), (4, 0), textcoords="offset points", va="center", color=INK
    )


def _fall(axes: Axes, row: int, before: float, after: float, scale: Scale) -> None:
    """Draw the decrease of the error by a change, and print the error after it."""
    axes.barh(row, after * scale.factor, THICK, color=DATA_GREY, alpha=0.35, linewidth=0, zorder=1)
    low, high = sorted((before, after))
    _bar(axes, row, low, high, scale, BLUE, f"{scale.text(after)}  ({change(before, after, 0)})")
    axes.plot(
        [before * scale.factor] * 2,
        [row - 1 + THICK / 2, row - THICK / 2],
        color=SOFT_INK,
        linewidth=0.5,
        zorder=1,
    )
