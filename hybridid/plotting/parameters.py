"""Figure: estimates with their 95 % intervals, relative precision and correlations."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from hybridid.declarations import Parameter
from hybridid.estimators.estimate import Estimate, EstimatedParameter
from hybridid.plotting.axes import frame
from hybridid.plotting.correlation_map import correlation_map, short_names
from hybridid.plotting.legends import legend_on_top
from hybridid.plotting.looks import INK, SOFT_INK, look
from hybridid.plotting.series import PlotError
from hybridid.plotting.style import DOUBLE_COLUMN, Plot, is_wide, new_figure, styled
from hybridid.quantities import Z95, estimated

ROW, MAP, FRAME = 8.0, 46.0, 20.0  # mm: one parameter, one correlation map, header and axes
SPREAD = 0.62  # part of a row that the estimates of several models share
MARKERS = "osD^vP"


@dataclass(frozen=True)
class _Panels:
    figure: Figure
    values: Axes
    precision: Axes
    maps: list[Axes]


@dataclass(frozen=True)
class _Entry:
    """One estimate with its height in the panel, the scale of its value, and its look."""

    parameter: EstimatedParameter
    y: float
    scale: float
    colour: str
    marker: str

    @property
    def half_width(self) -> float:
        """Half-width of the 95 % interval; zero if there is none."""
        half = Z95 * self.parameter.std
        return half if math.isfinite(half) else 0.0

    @property
    def percent(self) -> float:
        """Half-width in percent of the estimate; NaN without interval or at zero."""
        value = abs(self.parameter.value)
        return 100 * self.half_width / value if value and self.half_width else math.nan


@styled
def parameters_plot(
    estimates: Mapping[str, Estimate],
    declared: Sequence[Parameter],
    record: str,
    provenance: str,
    width: float = DOUBLE_COLUMN,
) -> Plot:
    """Estimates by model name: value over declared scale, relative interval, correlation.

    ``declared`` (the models' parameters) gives each one's scale and guess. A hollow marker is a parameter
    that is not identifiable. A parameter at a bound is marked beside its number.

    Raises:
        PlotError: if nothing was estimated.
    """
    shown = {model: e for model, e in estimates.items() if e.parameters}
    names = list(dict.fromkeys(p.name for e in shown.values() for p in e.parameters))
    if not names:
        raise PlotError(f"parameters of {record}: no estimate to plot; give at least one")
    panels = _panels(width, len(names), len(shown), f"{record} · parameters", provenance)
    entries = _entries(shown, names, {p.name: p.scale for p in declared})
    for entry in entries:
        _draw(panels, entry)
    known = [p for p in declared if p.name in names]
    guesses = [p.guess / p.scale for p in known], [names.index(p.name) for p in known]
    handles = panels.values.plot(
        *guesses,
        "|",
        color=SOFT_INK,
        markersize=11,
        markeredgewidth=0.8,
        label="guess",
    )
    for index, (model, estimate) in enumerate(shown.items()):
        colour, marker = look(index).colour, MARKERS[index % len(MARKERS)]
        handles += panels.values.plot([], [], marker, color=colour, markersize=3.2, label=model)
        of = [p.name for p in estimate.parameters]
        correlation_map(panels.maps[index], of, estimate.correlation, model, MAP / width)
    _dress_values(panels.values, names if is_wide(width) else short_names(names))
    _dress_precision(panels.precision, entries, is_wide(width), len(shown) > 1)
    legend_on_top(panels.figure, handles)
    caption = (
        f"Estimates for {', '.join(shown)} on {record} ({provenance}) with 95 % intervals: in multiples of "
        "their declared scale, the intervals' half-widths in percent of the estimates, and correlations."
    )
    return Plot(panels.figure, "parameters", caption, provenance)


def _panels(width: float, rows: int, maps: int, title: str, provenance: str) -> _Panels:
    """Panels for values, precision and correlation: in one row if they fit, else one below the other."""
    forest = FRAME + ROW * rows * (1 + 0.45 * (maps - 1))
    if is_wide(width) and maps == 1:
        figure = new_figure(width, max(forest, FRAME + MAP), title, provenance)
        grid = figure.add_gridspec(1, 3, width_ratios=(1.2, 0.9, 1.3))
        upper, lower = [grid[0], grid[1]], [grid[2]]
    elif is_wide(width):
        lines = -(-maps // 3)
        heights = [forest, *[FRAME + MAP] * lines]
        figure = new_figure(width, sum(heights), title, provenance)
        grid = figure.add_gridspec(1 + lines, 1, height_ratios=heights)
        top = grid[0].subgridspec(1, 2, width_ratios=(1.2, 0.9))
        below = [grid[1 + line].subgridspec(1, min(maps, 3)) for line in range(lines)]
        upper, lower = [top[0], top[1]], [below[k // 3][k % 3] for k in range(maps)]
    else:
        heights = [forest, forest, *[FRAME + MAP] * maps]
        figure = new_figure(width, sum(heights), title, provenance)
        grid = figure.add_gridspec(2 + maps, 1, height_ratios=heights)
        upper, lower = [grid[0], grid[1]], [grid[2 + k] for k in range(maps)]
    values = figure.add_subplot(upper[0])
    precision = figure.add_subplot(upper[1], sharey=values)
    return _Panels(figure, values, precision, [figure.add_subplot(cell) for cell in lower])


def _entries(shown: Mapping[str, Estimate], names: list[str], scales: Mapping[str, float]) -> list[_Entry]:
    entries = []
    for index, estimate in enumerate(shown.values()):
        shift = SPREAD * ((index + 0.5) / len(shown) - 0.5)
        for p in estimate.parameters:
            scale = scales.get(p.name) or abs(p.value) or 1.0
            marker = MARKERS[index % len(MARKERS)]
            entries.append(_Entry(p, names.index(p.name) + shift, scale, look(index).colour, marker))
    return entries


def _draw(panels: _Panels, entry: _Entry) -> None:
    face = entry.colour if entry.parameter.identifiable else "white"
    panels.values.errorbar(
        entry.parameter.value / entry.scale, entry.y, xerr=entry.half_width / entry.scale,
        color=entry.colour, marker=entry.marker, markersize=3.2, markeredgewidth=0.8, markerfacecolor=face,
        elinewidth=1.1, capsize=2, linestyle="", zorder=4,
    )  # fmt: skip
    if math.isfinite(entry.percent):
        panels.precision.hlines(entry.y, 1e-12, entry.percent, color=entry.colour, linewidth=1.1, zorder=3)
        panels.precision.plot(
            entry.percent, entry.y, color=entry.colour, marker=entry.marker, markersize=3.2,
            markeredgewidth=0.8, markerfacecolor=face, zorder=4,
        )  # fmt: skip


def _text(entry: _Entry) -> str:
    """``190.2 ± 0.4 N·s/m``: the interval with two significant digits, and what is wrong."""
    parameter = entry.parameter
    text = estimated(parameter.value, parameter.std, parameter.unit)
    flags = {"at bound": parameter.at_bound, "not identifiable": not parameter.identifiable}
    return ", ".join([text, *(flag for flag, raised in flags.items() if raised)])


def _dress_values(axes: Axes, names: Sequence[str]) -> None:
    axes.set_yticks(range(len(names)), names)
    axes.set_ylim(len(names) - 0.45, -0.55)
    axes.set_xlabel("estimate / scale [–]")
    axes.set_xlim(frame([np.asarray(line.get_xdata(), dtype=float) for line in axes.get_lines()], 0.08))
    if axes.get_xlim()[0] < 0 < axes.get_xlim()[1]:
        axes.axvline(0.0, color=SOFT_INK, linewidth=0.5, zorder=1)
    axes.tick_params(axis="y", length=0)


def _dress_precision(axes: Axes, entries: Sequence[_Entry], wide: bool, several: bool) -> None:
    """Set whole decades on the axis, and print each estimate at the right."""
    axes.set_xscale("log")
    percents = [e.percent for e in entries if math.isfinite(e.percent)] or [1.0]
    low, high = math.floor(math.log10(min(percents) / 1.4)), math.ceil(math.log10(max(percents) * 1.4))
    axes.set_xlim(10.0**low, 10.0**high)
    axes.minorticks_off()
    axes.xaxis.set_major_formatter(lambda value, _: f"{value:g}")
    axes.set_xlabel("95 % interval [± %]")
    axes.tick_params(axis="y", length=0, labelleft=not wide)
    beside = axes.secondary_yaxis("right")
    beside.set_yticks([e.y for e in entries], [_text(e) for e in entries])
    for tick, entry in zip(beside.get_yticklabels(), entries, strict=True):
        tick.set_color(entry.colour if several else INK)
    beside.tick_params(length=0)
    beside.spines["right"].set_visible(False)
