"""Figure: the effort that resists at a port over its velocity, or the flow that leaves over its level."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.container import ErrorbarContainer
from matplotlib.figure import Figure

from hybridid.declarations import Port
from hybridid.plotting.axes import Array, Scale, draw, frame, name_y, scale_for
from hybridid.plotting.legends import legend_on_top
from hybridid.plotting.looks import DATA_GREY, INK, SOFT_INK, Look, look
from hybridid.plotting.series import PlotError
from hybridid.plotting.style import DOUBLE_COLUMN, Plot, is_wide, new_figure, styled

BINS = 30  # of equal width over the middle 99 % of the velocities
LEAST_IN_BIN = 20  # samples, for a median and its spread
DOTS = 6000  # of the data's cloud; more points make it opaque


@dataclass(frozen=True)
class FrictionCurve:
    """Efforts of one model's effects at a port, by name, each (n,) ``over`` its velocity or level (n,).

    A sorted velocity gives curves. The velocity of a trajectory gives the hysteresis loops of effects with
    memory.
    """

    model: str
    over: Array
    efforts: Mapping[str, Array]

    def __post_init__(self) -> None:
        for name, effort in self.efforts.items():
            if np.shape(effort) != np.shape(self.over):
                raise PlotError(
                    f"friction of {self.model}: effect {name} has {np.size(effort)} efforts for "
                    f"{len(self.over)} velocities; they must be as many"
                )

    @property
    def total(self) -> Array:
        """Sum of the efforts, (n,)."""
        return np.sum([np.zeros(len(self.over)), *self.efforts.values()], axis=0)


@dataclass(frozen=True)
class _Words:
    title: str
    over: str
    unit: str
    effort: str
    caption: str


def _words(port: Port) -> _Words:
    unit = port.position_unit
    if port.kind == "flow":
        return _Words("flows", "level", unit, "flow that leaves", "Flow that leaves {} over its level")
    resists = "Effort that resists the motion of {} over its velocity"
    return _Words("friction", "velocity", f"{unit}/s", "resisting effort", resists)


@dataclass(frozen=True)
class FrictionData:
    """The effort found from a record, e.g. ``force - M a``, over the velocity or level, both (n,)."""

    over: Array
    effort: Array


@styled
def friction_plot(
    port: Port,
    curves: Sequence[FrictionCurve],
    record: str,
    provenance: str,
    data: FrictionData | None = None,
    width: float = DOUBLE_COLUMN,
) -> Plot:
    """Every model's total effort over velocity with the data; and the effort by effect, one panel a model.

    At a flow port, flows over the level.

    ``record`` and ``provenance`` are those of the fitted record and of the data.

    Raises:
        PlotError: if there is no curve.
    """
    if not curves:
        raise PlotError(f"friction at {port.name}: no model's curve to plot; give at least one")
    words, wide = _words(port), is_wide(width)
    height = 20 + (36 * max(2, len(curves)) if wide else 52 + 38 * len(curves))
    figure = new_figure(width, height, f"{record} · {words.title} at {port.name}", provenance)
    overview, details = _layout(figure, len(curves), wide)
    over = scale_for(f"{words.over} of {port.name}", words.unit, *(c.over for c in curves))
    effort = scale_for(words.effort, port.effort_unit, *(c.total for c in curves))
    looks = _effect_looks(curves)
    totals: list[Any] = []
    effects: dict[str, Artist] = {}
    seen = [c.total for c in curves]
    if data is not None:
        dots, spread = _cloud(overview, data, over, effort, provenance)
        totals.append(dots)
        seen.append(spread)
    for index, curve in enumerate(curves):
        total = (curve.over * over.factor, curve.total * effort.factor)
        totals.append(draw(overview, *total, look(index), f"{curve.model}, total"))
        draw(details[index], *total, replace(look(index), width=1.5), curve.model)
        for name, values in curve.efforts.items():
            label = name.replace("_", " ")
            effects[name] = draw(details[index], total[0], values * effort.factor, looks[name], label)
        details[index].set_ylim(frame([v * effort.factor for v in (*curve.efforts.values(), curve.total)]))
        details[index].set_title(f"{curve.model}, by effect")
    overview.set_title("total")
    overview.set_ylim(frame([v * effort.factor for v in seen]))
    for axes in (overview, *details):
        _cross(axes)
        axes.set_xlim(frame([c.over * over.factor for c in curves], 0.02))
        name_y(axes, effort)
    for axes in (overview, details[-1]):
        axes.set_xlabel(over.label)
    legend_on_top(figure, [*totals, *effects.values()])
    return Plot(figure, f"friction_{port.name}", _caption(port, curves, record, provenance, data), provenance)


def _layout(figure: Figure, count: int, wide: bool) -> tuple[Axes, list[Axes]]:
    if wide:
        grid = figure.add_gridspec(count, 2, width_ratios=(1.25, 1))
        overview, cells = figure.add_subplot(grid[:, 0]), [grid[row, 1] for row in range(count)]
    else:
        grid = figure.add_gridspec(count + 1, 1, height_ratios=(1.5, *[1] * count))
        overview, cells = figure.add_subplot(grid[0]), [grid[row + 1] for row in range(count)]
    return overview, [figure.add_subplot(cell, sharex=overview) for cell in cells]


def _effect_looks(curves: Sequence[FrictionCurve]) -> dict[str, Look]:
    """A look for each effect: the same in every panel, and different from those of the models."""
    names = dict.fromkeys(name for curve in curves for name in curve.efforts)
    return {name: look(len(curves) + order) for order, name in enumerate(names)}


def _cross(axes: Axes) -> None:
    axes.axhline(0.0, color=SOFT_INK, linewidth=0.5, zorder=1)
    axes.axvline(0.0, color=SOFT_INK, linewidth=0.5, zorder=1)


def _cloud(
    axes: Axes, data: FrictionData, over: Scale, effort: Scale, provenance: str
) -> tuple[Artist | ErrorbarContainer, Array]:
    """Draw a thinned cloud and, in bins of velocity or level, the median with the middle 80 % of the efforts.

    Returns the legend's handle and the efforts that the axes must include.
    """
    step = max(1, len(data.over) // DOTS)
    axes.plot(
        data.over[::step] * over.factor, data.effort[::step] * effort.factor, ".",
        color=DATA_GREY, markersize=2.2, markeredgewidth=0, alpha=0.5, rasterized=True, zorder=1,
    )  # fmt: skip
    first, last = np.quantile(data.over, (0.005, 0.995))
    edges = np.linspace(float(first), float(last), BINS + 1)
    members = [(data.over >= a) & (data.over < b) for a, b in pairwise(edges)]
    full = [m for m in members if m.sum() >= LEAST_IN_BIN]
    if not full:
        return axes.plot([], [], ".", color=DATA_GREY, label=provenance)[0], data.effort
    centre = np.array([np.median(data.over[m]) for m in full])
    low, middle, high = np.array([np.quantile(data.effort[m], (0.1, 0.5, 0.9)) for m in full]).T
    bars = np.array([middle - low, high - middle]) * effort.factor
    label = f"{provenance}, median and 10–90 %"
    handle = axes.errorbar(
        centre * over.factor, middle * effort.factor, bars,
        fmt="o", markersize=2.0, color=INK, elinewidth=0.5, zorder=2, label=label,
    )  # fmt: skip
    return handle, np.concatenate([low, high])


def _caption(
    port: Port, curves: Sequence[FrictionCurve], record: str, provenance: str, data: FrictionData | None
) -> str:
    found = "" if data is None else ", on the efforts found from the record (dots: medians, bars: 10–90 %)"
    return (
        f"{_words(port).caption.format(port.name)}, total and by effect, for "
        f"{', '.join(c.model for c in curves)} on {record} ({provenance}){found}."
    )
