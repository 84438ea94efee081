"""Figure: the same comparison in many panels: responses, errors, spectra or scatter."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D

from hybridid.plotting.axes import Array, Scale, draw, frame, frame_data, name_y, scale_for
from hybridid.plotting.legends import legend_on_top
from hybridid.plotting.lettering import shorten
from hybridid.plotting.looks import FOCUS, SOFT_INK, Look
from hybridid.plotting.series import PlotError
from hybridid.plotting.style import DOUBLE_COLUMN, Plot, is_wide, new_figure, styled

ROW = 34.0  # mm
BLOCKS = 350  # extremes per line: panels are narrower than a figure
DOTS = 700  # of a scatter; more points make it opaque
DECADES = 5.0  # of a logarithmic panel shown below its highest value

Kind = Literal["series", "spectrum", "scatter"]


@dataclass(frozen=True)
class Line:
    """One curve, (n,) over ``x`` (n,); lines with one ``label`` share an entry of the legend."""

    label: str
    x: Array
    y: Array
    look: Look


@dataclass(frozen=True)
class Panel:
    """Lines over one quantity; the first is the data, which the limits follow.

    ``x`` and ``y`` are names and units. ``focus`` is the range of x that a second panel beside this one
    enlarges. ``spectrum`` has logarithmic axes. ``scatter`` has dots, equal axes and the diagonal of a
    perfect model.
    """

    title: str
    x: tuple[str, str]
    y: tuple[str, str]
    lines: Sequence[Line]
    kind: Kind = "series"
    focus: tuple[float, float] | None = None

    def __post_init__(self) -> None:
        if not self.lines:
            raise PlotError(f"panel {self.title}: no line to draw; give at least one")
        for line in self.lines:
            if np.shape(line.x) != np.shape(line.y):
                raise PlotError(
                    f"panel {self.title}, {line.label}: {np.size(line.y)} values over {np.size(line.x)} "
                    "places; they must be as many"
                )


@styled
def panels_plot(
    name: str,
    title: str,
    panels: Sequence[Panel],
    caption: str,
    provenance: str,
    columns: int = 1,
    row: float = ROW,
    width: float = DOUBLE_COLUMN,
) -> Plot:
    """``panels`` in ``columns`` (one if the figure is narrow) and rows of ``row`` mm, under one legend.

    Raises:
        PlotError: if there is no panel.
    """
    if not panels:
        raise PlotError(f"{name}: no panel to draw; give at least one")
    columns = columns if is_wide(width) else 1
    rows = -(-len(panels) // columns)
    figure = new_figure(width, 12 + row * rows, title, provenance)
    beside = any(panel.focus is not None for panel in panels) and is_wide(width)
    parts = 2 if beside else 1
    grid = figure.add_gridspec(rows, parts * columns, width_ratios=[2.1, 1][:parts] * columns)
    handles: dict[str, Line2D] = {}
    for number, panel in enumerate(panels):
        at, place = divmod(number, columns)
        before = len(figure.axes)
        axes = figure.add_subplot(grid[at, parts * place])
        drawn, scales = _panel(axes, panel, 0.7 / columns)
        handles = {**drawn, **handles}
        if beside and panel.focus is not None:
            _enlarged(figure.add_subplot(grid[at, parts * place + 1]), axes, panel, scales)
        if number + columns < len(panels) and panels[number + columns].x == panel.x:
            for shown in figure.axes[before:]:
                shown.set_xlabel("")
    legend_on_top(figure, list(handles.values()))
    figure.align_ylabels()
    return Plot(figure, name, caption, provenance)


def _panel(axes: Axes, panel: Panel, room: float) -> tuple[dict[str, Line2D], tuple[Scale, Scale]]:
    """Draw the lines of one panel; returns the legend's handles and the scales."""
    first = panel.lines[0]
    y = scale_for(*panel.y, first.y, *([] if panel.kind == "series" else [line.y for line in panel.lines]))
    x = Scale(panel.x[0], 1.0, panel.x[1]) if panel.kind == "spectrum" else scale_for(*panel.x, first.x)
    x = y if panel.kind == "scatter" else x
    x = Scale(panel.x[0].replace("_", " "), x.factor, x.unit)
    handles = {line.label: _line(axes, panel.kind, line, x, y) for line in panel.lines}
    _LIMITS[panel.kind](axes, panel, x, y)
    axes.set_xlabel(x.label)
    name_y(axes, y)
    shorten(axes.set_title(panel.title), room)
    return handles, (x, y)


def _line(axes: Axes, kind: Kind, line: Line, x: Scale, y: Scale) -> Line2D:
    if kind != "scatter":
        at = (line.x * x.factor, line.y * y.factor)
        return draw(axes, *at, line.look, line.label, blocks=BLOCKS)
    step = max(1, len(line.x) // DOTS)
    dots = (line.x[::step] * x.factor, line.y[::step] * y.factor)
    return axes.plot(
        *dots, ".", color=line.look.colour, markersize=3.0, markeredgewidth=0, alpha=0.6, label=line.label,
        rasterized=True,
    )[0]  # fmt: skip


def _limit_series(axes: Axes, panel: Panel, x: Scale, y: Scale) -> None:
    first, *others = panel.lines
    low, high = frame_data(first.y, [line.y for line in others])
    axes.set_ylim(low * y.factor, high * y.factor)
    axes.set_xlim(first.x[0] * x.factor, first.x[-1] * x.factor)
    if low < 0 < high:
        axes.axhline(0.0, color=SOFT_INK, linewidth=0.4, zorder=1)
    if panel.focus is not None:
        axes.axvspan(*(edge * x.factor for edge in panel.focus), color=FOCUS, zorder=0)


def _limit_spectrum(axes: Axes, panel: Panel, x: Scale, y: Scale) -> None:
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.minorticks_off()
    axes.xaxis.set_major_formatter(lambda value, _: f"{value:g}")
    seen = np.concatenate([line.y[line.y > 0] for line in panel.lines])
    if len(seen):
        highest = float(seen.max())
        axes.set_ylim(max(float(seen.min()), highest * 10.0**-DECADES) * y.factor / 2, highest * y.factor * 2)
    axes.set_xlim(panel.lines[0].x[0], panel.lines[0].x[-1])


def _limit_scatter(axes: Axes, panel: Panel, x: Scale, y: Scale) -> None:
    both = [line.x * x.factor for line in panel.lines] + [line.y * y.factor for line in panel.lines]
    limits = frame(both, 0.04)
    axes.plot(limits, limits, color=SOFT_INK, linewidth=0.6, zorder=1)
    axes.set_xlim(limits)
    axes.set_ylim(limits)
    axes.set_aspect("equal")


_LIMITS = {"series": _limit_series, "spectrum": _limit_spectrum, "scatter": _limit_scatter}


def _enlarged(axes: Axes, whole: Axes, panel: Panel, scales: tuple[Scale, Scale]) -> None:
    """The range ``panel.focus`` of the panel, with thinning of its own."""
    assert panel.focus is not None
    x, y = scales
    seen = []
    for line in panel.lines:
        inside = (line.x >= panel.focus[0]) & (line.x <= panel.focus[1])
        part = Line(line.label, line.x[inside], line.y[inside], line.look)
        _line(axes, panel.kind, part, x, y)
        seen.append(np.clip(part.y * y.factor, *whole.get_ylim()))
    axes.set_facecolor(FOCUS)
    axes.set_xlim(panel.focus[0] * x.factor, panel.focus[1] * x.factor)
    axes.set_ylim(frame(seen))
    axes.set_xlabel(x.label)
