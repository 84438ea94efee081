"""Figure: the missing effort or flow at a port, over time and over what it could depend on."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import pairwise

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from hybridid.plotting.axes import Array, Scale, draw, name_y, scale_for, shade, time_scale
from hybridid.plotting.legends import legend_on_top
from hybridid.plotting.looks import SOFT_INK, Look, look
from hybridid.plotting.series import PlotError
from hybridid.plotting.style import DOUBLE_COLUMN, Plot, new_figure, styled
from hybridid.plotting.thinning import broken
from hybridid.quantities import Z95
from hybridid.trace.ports.missing_effort import MissingEffort

BINS = 30  # of equal width over the middle 99 % of each variable
BLOCKS = 400  # blocks of the record; the bold line over time joins their means
LEAST_IN_BIN = 20  # samples, for a median and its spread
DOTS = 2500  # a cloud; more points make it opaque
COLUMNS = 3
PANEL, OVERVIEW = 36.0, 27.0  # mm
MIDDLE = (0.005, 0.995)  # quantiles that the bins cover


@styled
def missing_effort_plot(
    efforts: Mapping[str, MissingEffort],
    inputs: Mapping[str, tuple[Array, str]],
    width: float = DOUBLE_COLUMN,
) -> Plot:
    """The effort over time with its band, and over the port's motion and the inputs.

    ``efforts`` holds one entry for each model, all of one port and record; ``inputs`` holds values (n,) and
    unit by name, n the samples of the record.

    Raises:
        PlotError: if there is no effort, or they are of different ports or records.
    """
    shown = list(efforts.values())
    if not shown:
        raise PlotError("missing effort: nothing to draw; give at least one model's")
    one = shown[0]
    if any((e.port, e.record) != (one.port, one.record) for e in shown):
        raise PlotError("missing effort: give efforts of one port on one record")
    variables = _variables(efforts, inputs)
    count = len(variables)
    rows = -(-count // COLUMNS)
    title = f"{one.record} · missing {one.kind} at {one.port}"
    figure = new_figure(width, 24 + OVERVIEW * len(shown) + PANEL * rows, title, one.provenance)
    overviews, panels = _layout(figure, len(shown), count, rows)
    scale = scale_for(f"missing {one.kind}", one.unit, *(e.effort for e in shown))
    limits = _limits(shown, scale.factor)
    handles = [
        _over_time(axes, k, name, efforts[name], scale)
        for k, (axes, name) in enumerate(zip(overviews, efforts, strict=True))
    ]
    for axes in overviews:
        axes.set_ylim(limits)
    for axes, (name, unit, values) in zip(panels, variables, strict=True):
        _over(axes, efforts, values, scale_for(name, unit, *values), scale)
    for axes in (*overviews, *panels[::COLUMNS]):
        name_y(axes, scale)
    panels[0].set_ylim(limits)
    legend_on_top(figure, handles)
    shaded = "; shaded: masked, does not count" if any(len(e.holes) for e in shown) else ""
    if any(e.rests for e in shown):
        shaded = "; shaded: at rest, where friction takes up what is missing, or masked"
    acts = "Flow that leaves" if one.kind == "flow" else "Effort that resists"
    caption = (
        f"{acts} at {one.port} on {one.record} ({one.provenance}) beyond the model, estimated "
        f"by a smoother, for {', '.join(efforts)}: over time (thin: samples; bold: their means over "
        f"{1e3 * _block(one):.0f} ms; band: 95 % of a sample), and over what it could depend on (dots: "
        "samples; circles: medians in bins, bars: the middle 80 %)"
        f"{shaded}."
    )
    return Plot(figure, f"missing_effort_{one.port}", caption, one.provenance)


def _layout(figure: Figure, models: int, count: int, rows: int) -> tuple[list[Axes], list[Axes]]:
    """One panel over time for each model, then one for each variable."""
    heights = (*[OVERVIEW] * models, *[PANEL] * rows)
    grid = figure.add_gridspec(models + rows, COLUMNS, height_ratios=heights)
    overviews = [figure.add_subplot(grid[k, :]) for k in range(models)]
    panels: list[Axes] = []
    for k in range(count):
        cell = grid[models + k // COLUMNS, k % COLUMNS]
        panels.append(figure.add_subplot(cell, sharey=panels[0] if panels else None))
        panels[k].tick_params(labelleft=k % COLUMNS == 0)
    for axes in overviews[:-1]:
        axes.tick_params(labelbottom=False)
    return overviews, panels


def _over_time(axes: Axes, index: int, name: str, found: MissingEffort, scale: Scale) -> Line2D:
    """Draw samples, their means over short blocks and the band; returns the line for the legend."""
    time, style = time_scale(found.time), look(index)
    x, means, spread = (_block_means(v, BLOCKS) for v in (found.time, found.effort, found.std))
    for start, stop in found.holes:  # of a block that straddles one, the mean would lie in it
        outside = (x <= start) | (x >= stop)
        x, means, spread = x[outside], means[outside], spread[outside]
    resumed = found.holes[:, 1]
    ends = [broken(x, means + side * Z95 * spread, resumed) for side in (-1, 1)]
    low, high = (edge * scale.factor for _, edge in ends)
    axes.fill_between(ends[0][0] * time.factor, low, high, color=style.colour, alpha=0.15, linewidth=0)
    raw = Look(style.colour, width=0.3, above=2)
    times = found.time * time.factor
    draw(axes, times, found.effort * scale.factor, raw, "", resumed * time.factor).set_alpha(0.45)
    shade(axes, found.holes, time.factor)
    x, means = broken(x, means, resumed)
    rms = scale.text(float(np.sqrt(np.mean(found.effort**2))))
    line = axes.plot(
        x * time.factor, means * scale.factor, color=style.colour, linewidth=1.2, zorder=4,
        label=f"{name}: {rms} RMS",
    )[0]  # fmt: skip
    axes.axhline(0.0, color=SOFT_INK, linewidth=0.5, zorder=1)
    axes.set_xlim(found.time[0] * time.factor, found.time[-1] * time.factor)
    axes.set_xlabel(time.label if axes.xaxis.get_tick_params()["labelbottom"] else "")
    return line


def _block_means(values: Array, blocks: int) -> Array:
    """Means over consecutive blocks of equal length, the last one shorter."""
    size = -(-len(values) // blocks)
    starts = np.arange(0, len(values), size)
    return np.add.reduceat(values, starts) / np.diff(np.append(starts, len(values)))


def _block(found: MissingEffort) -> float:
    """Seconds in a block."""
    return -(-len(found.time) // BLOCKS) * float(found.time[1] - found.time[0])


def _variables(
    efforts: Mapping[str, MissingEffort], inputs: Mapping[str, tuple[Array, str]]
) -> list[tuple[str, str, list[Array]]]:
    """Name, unit and values by model of each variable over which the effort is drawn."""
    shown = list(efforts.values())
    motion = shown[0].motion
    return [
        *((name, unit, [e.motion[name][0] for e in shown]) for name, (_, unit) in motion.items()),
        *((name, unit, [e.of(values) for e in shown]) for name, (values, unit) in inputs.items()),
    ]


def _over(
    axes: Axes, efforts: Mapping[str, MissingEffort], values: Sequence[Array], variable: Scale, scale: Scale
) -> None:
    for index, (e, x) in enumerate(zip(efforts.values(), values, strict=True)):
        colour, step = look(index).colour, max(1, len(x) // DOTS)
        axes.plot(
            x[::step] * variable.factor, e.effort[::step] * scale.factor, ".",
            color=colour, markersize=1.6, markeredgewidth=0, alpha=0.25, rasterized=True, zorder=2 + index,
        )  # fmt: skip
        centre, low, middle, high = _bins(x, e.effort)
        bars = np.array([middle - low, high - middle]) * scale.factor
        axes.errorbar(
            centre * variable.factor, middle * scale.factor, bars,
            fmt="o-", markersize=2.6, color=colour, linewidth=0.7, elinewidth=0.5, zorder=6 + index,
            markeredgecolor="white", markeredgewidth=0.3,
        )  # fmt: skip
    axes.axhline(0.0, color=SOFT_INK, linewidth=0.5, zorder=1)
    low_x, high_x = np.quantile(np.concatenate(values), (0.001, 0.999)) * variable.factor
    margin = 0.04 * (high_x - low_x) or 1.0
    axes.set_xlim(low_x - margin, high_x + margin)
    axes.set_xlabel(variable.label)


def _bins(x: Array, effort: Array) -> tuple[Array, Array, Array, Array]:
    """Median of ``x`` and 10, 50, 90 % of ``effort`` in bins of equal width that hold enough samples."""
    first, last = np.quantile(x, MIDDLE)
    edges = np.linspace(first, last, BINS + 1)
    members = [(x >= a) & (x <= b) for a, b in pairwise(edges)]
    full = [m for m in members if m.sum() >= LEAST_IN_BIN] or [np.ones(len(x), dtype=bool)]
    centre = np.array([np.median(x[m]) for m in full])
    low, middle, high = np.array([np.quantile(effort[m], (0.1, 0.5, 0.9)) for m in full]).T
    return centre, low, middle, high


def _limits(shown: Sequence[MissingEffort], factor: float) -> tuple[float, float]:
    """Limits around the middle 96 % of every effort, with a wide margin."""
    low, high = np.quantile(np.concatenate([e.effort for e in shown]), (0.02, 0.98)) * factor
    margin = 0.4 * (high - low) or 1.0
    return low - margin, high + margin
