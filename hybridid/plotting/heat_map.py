"""Figure: a number over a grid of two settings, one panel for each value of the others."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import LogNorm, Normalize
from matplotlib.patches import Rectangle
from matplotlib.ticker import FuncFormatter, NullFormatter

from hybridid.plotting.axes import Array
from hybridid.plotting.lettering import cut
from hybridid.plotting.looks import GRID_GREY, INK, VERMILION
from hybridid.plotting.series import PlotError
from hybridid.plotting.style import DOUBLE_COLUMN, Plot, is_wide, new_figure, styled
from hybridid.quantities import NONE, engineering, number

ROW, ABOVE = 8.0, 16.0  # mm, of a cell, and of a panel's title and axis
MOST = 12  # panels that are drawn
WRITTEN = 12  # columns up to which the numbers stand in the cells
_SPAN = 8.0  # ratio of the largest to the smallest number above which the colours are logarithmic
_DARK = 0.45  # below this lightness the numbers are white


@dataclass(frozen=True, eq=False)
class Cells:
    """``values`` and their ``spread``, both (rows, columns); nan for an empty cell or an unknown spread.

    ``chosen`` is the row and column of the framed cell.
    """

    title: str
    values: Array
    spread: Array
    chosen: tuple[int, int] | None = None


@styled
def heat_map_plot(
    panels: Sequence[Cells],
    rows: tuple[str, Sequence[str]],
    columns: tuple[str, Sequence[str]],
    measure: tuple[str, str],
    title: str,
    provenance: str,
    width: float = DOUBLE_COLUMN,
) -> Plot:
    """``rows`` and ``columns`` give a setting's name and its values, ``measure`` the number's name and unit,
    ``title`` what the number is.

    Darker is smaller. At most ``MOST`` panels.

    Raises:
        PlotError: if there is no number to show, or a panel's shape is not that of rows and columns.
    """
    shown = panels[:MOST]
    shape = (len(rows[1]), len(columns[1]))
    for panel in shown:
        if panel.values.shape != shape or panel.spread.shape != shape:
            raise PlotError(f"heat map: panel {panel.title!r} is {panel.values.shape}, expected {shape}")
    found = [panel.values[np.isfinite(panel.values) & (panel.values > 0)] for panel in shown]
    if not sum(map(len, found)):
        raise PlotError(f"heat map: no finite number of {measure[0]}")
    numbers = np.concatenate(found)
    factor, unit = engineering(float(np.median(numbers)), measure[1])
    beside = min(len(shown), 3 if is_wide(width) else 1)
    lines = -(-len(shown) // beside)
    figure = new_figure(width, 8 + lines * (ABOVE + ROW * shape[0]), title, provenance)
    grid = figure.subplots(lines, beside, squeeze=False).ravel()
    norm = _norm(factor * float(numbers.min()), factor * float(numbers.max()))
    for axes, panel in zip(grid, shown, strict=False):
        _draw(axes, panel, rows, columns, factor, norm)
    for axes in grid[len(shown) :]:
        axes.set_visible(False)
    # the title says what the number is: on a low figure a longer label would leave the page
    bar = figure.colorbar(grid[0].images[0], ax=list(grid), label=f"[{unit}]", fraction=0.03, aspect=12)
    bar.ax.yaxis.set_major_formatter(FuncFormatter(lambda value, _: number(value)))
    bar.ax.yaxis.set_minor_formatter(NullFormatter())
    bar.outline.set_visible(False)
    left_out = f"; {MOST} panels of {len(panels)}" if len(panels) > MOST else ""
    over = " and ".join(name.partition(" [")[0] for name, _ in (rows, columns) if name)
    several = any(np.isfinite(panel.spread).any() for panel in shown)
    seeds = ", mean ± standard deviation over seeds where there are several" if several else ""
    framed = "; framed: chosen" if any(panel.chosen for panel in shown) else ""
    caption = (
        f"{measure[0][:1].upper()}{measure[0][1:]} in {unit} over {over} ({provenance})"
        f"{seeds}{framed}{left_out}."
    )
    return Plot(figure, "heat_map", caption, provenance)


def _norm(low: float, high: float) -> Normalize:
    """Linear colours, or logarithmic ones if the numbers span a decade or more."""
    if high > _SPAN * low:
        return LogNorm(low, high)
    return Normalize(low, high if high > low else 1.001 * low)


def _draw(
    axes: Axes,
    panel: Cells,
    rows: tuple[str, Sequence[str]],
    columns: tuple[str, Sequence[str]],
    factor: float,
    norm: Normalize,
) -> None:
    values = factor * panel.values
    axes.set_facecolor(GRID_GREY)
    positive = np.ma.masked_invalid(np.where(values > 0, values, np.nan))
    axes.imshow(positive, cmap="viridis", norm=norm, aspect="auto", interpolation="nearest")
    axes.set_xticks(range(len(columns[1])), columns[1])
    axes.set_yticks(range(len(rows[1])), rows[1])
    axes.set_xlabel(columns[0])
    axes.set_ylabel(rows[0])
    axes.tick_params(length=0)
    axes.grid(False)
    axes.spines[:].set_visible(False)
    axes.set_title(cut(panel.title, 40))
    if len(columns[1]) <= WRITTEN:
        for (row, column), value in np.ndenumerate(values):
            lightness = float(norm(value)) if value > 0 else 1.0
            axes.text(
                column, row, _text(float(value), factor * float(panel.spread[row, column])),
                ha="center", va="center", fontsize=6, color="white" if lightness < _DARK else INK,
            )  # fmt: skip
    if panel.chosen is not None:
        row, column = panel.chosen
        place = (column - 0.47, row - 0.45)
        frame = Rectangle(place, 0.94, 0.9, fill=False, edgecolor=VERMILION, linewidth=1.6, clip_on=False)
        axes.add_patch(frame)


def _text(value: float, spread: float) -> str:
    below = f"\n± {number(spread, 2)}" if np.isfinite(value) and np.isfinite(spread) else ""
    return number(value, 3, missing=NONE) + below
