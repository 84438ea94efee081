"""Figure: the distributions of the errors of several models on several records."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes

from hybridid.plotting.axes import Array, Scale, frame, scale_for
from hybridid.plotting.lettering import cut
from hybridid.plotting.looks import INK, SOFT_INK, look
from hybridid.plotting.series import PlotError, Response, one_output
from hybridid.plotting.style import DOUBLE_COLUMN, Plot, new_figure, styled

ROW = 15.0  # mm
KERNEL_SAMPLES = 3000  # that set the width of the kernel; neighbours are alike, so more say nothing more
DRAWN, BINS = 240, 960  # points of the density's line, and bins of the values that it is smoothed from
ROUNDING = 1e-9  # of the largest error: what differs by less is all equal, and has no density
DROPS = 350
NAME = 30  # characters of a row's name that are printed
CLOUD, BOX, RAIN = 0.42, 0.09, 0.30  # heights as parts of a row: above, on and below its line


@styled
def raincloud_plot(responses: Sequence[Response], width: float = DOUBLE_COLUMN) -> Plot:
    """One row for each response: half violin (kernel density), box (5, 25, 50, 75, 95 %), thinned scatter.

    Source: Allen et al. (2019), "Raincloud plots", Wellcome Open Research 4:63.

    Raises:
        PlotError: if there is no response, they show different outputs, or an error is not finite.
    """
    any_of = one_output(responses, one_record=False)
    for response in responses:
        if not len(response.time) or not np.isfinite(response.error).all():
            raise PlotError(f"raincloud: errors of {response.model} on {response.record} are not finite")
    provenance = _provenance(responses)
    models = list(dict.fromkeys(r.model for r in responses))
    scale = scale_for(f"{any_of.output} error", any_of.unit, *(r.error for r in responses))
    figure = new_figure(width, 18 + ROW * len(responses), scale.name, provenance)
    axes = figure.subplots()
    axes.axvline(0.0, color=SOFT_INK, linewidth=0.5, zorder=1)
    for row, response in enumerate(responses):
        _cloud(axes, -row, response.error * scale.factor, look(models.index(response.model)).colour)
    for index, model in enumerate(models):
        rows = [(-k, r.error * scale.factor) for k, r in enumerate(responses) if r.model == model]
        _boxes(axes, rows, look(index).colour)
        _rain(axes, rows, look(index).colour)
    axes.set_xlabel(scale.label)
    axes.set_xlim(frame([r.error * scale.factor for r in responses], 0.03))
    _rows(axes, responses, scale)
    listed = ", ".join(dict.fromkeys(f"{r.record} ({r.provenance})" for r in responses))
    caption = (
        f"Errors (recorded minus model) of {any_of.output} for {', '.join(models)} on {listed}: density, box "
        "(5, 25, 50, 75 and 95 %) and single samples, with the RMSE at the right."
    )
    return Plot(figure, "raincloud", caption, provenance)


def _provenance(responses: Sequence[Response]) -> str:
    """``measured`` only if all records are."""
    kinds = dict.fromkeys(r.provenance for r in responses)
    return " and ".join(sorted(kinds))


def _cloud(axes: Axes, base: float, values: Array, colour: str) -> None:
    if np.ptp(values) > ROUNDING * np.abs(values).max():
        grid, density = _density(values)
        top = base + 0.5 * BOX + 0.04 + CLOUD * density / density.max()
        axes.fill_between(grid, base + 0.5 * BOX + 0.04, top, color=colour, alpha=0.55, linewidth=0, zorder=2)
        axes.plot(grid, top, color=colour, linewidth=0.7, zorder=3)


def _density(values: Array) -> tuple[Array, Array]:
    """Where the kernel density of ``values`` (n,) is drawn, and its height there up to a factor, both
    (DRAWN,): a Gaussian of Scott's width over the values counted in bins.

    Source: Scott (1992), Multivariate Density Estimation; Silverman (1982), Algorithm AS 176, Appl. Stat.
    31(1).
    """
    counts, edges = np.histogram(values, BINS)
    width = values.std() * min(len(values), KERNEL_SAMPLES) ** -0.2 / (edges[1] - edges[0])
    half = int(np.ceil(4 * width))
    kernel = np.exp(-0.5 * (np.arange(-half, half + 1) / width) ** 2)
    smooth = np.convolve(counts, kernel)[half : half + BINS]
    grid = np.linspace(values.min(), values.max(), DRAWN)
    return grid, np.interp(grid, 0.5 * (edges[1:] + edges[:-1]), smooth)


def _boxes(axes: Axes, rows: Sequence[tuple[float, Array]], colour: str) -> None:
    """A box for each of ``rows``, (base, values)."""
    axes.bxp(
        [_box(values) for _, values in rows], positions=[base for base, _ in rows], widths=BOX,
        orientation="horizontal", showfliers=False,
        manage_ticks=False, patch_artist=True, zorder=4,
        boxprops={"facecolor": colour, "edgecolor": INK, "linewidth": 0.5},
        medianprops={"color": "white", "linewidth": 1.2, "solid_capstyle": "butt"},
        whiskerprops={"color": INK, "linewidth": 0.6}, capprops={"linewidth": 0},
    )  # fmt: skip


def _rain(axes: Axes, rows: Sequence[tuple[float, Array]], colour: str) -> None:
    """Single samples below the lines of ``rows``, (base, values), as one picture: many take long to draw."""
    drops, below = [], []
    for base, values in rows:
        drops.append(values[:: max(1, len(values) // DROPS)])
        jitter = np.random.default_rng(0).uniform(0.0, 1.0, len(drops[-1]))
        below.append(base - 0.5 * BOX - 0.05 - RAIN * jitter)
    x, y = np.concatenate(drops), np.concatenate(below)
    axes.plot(x, y, ".", color=colour, markersize=1.8, markeredgewidth=0, alpha=0.6, rasterized=True)


def _box(values: Array) -> dict[str, float]:
    quantiles = np.quantile(values, (0.05, 0.25, 0.5, 0.75, 0.95))
    return dict(zip(("whislo", "q1", "med", "q3", "whishi"), map(float, quantiles), strict=True))


def _rows(axes: Axes, responses: Sequence[Response], scale: Scale) -> None:
    """Names at the left, root mean square errors at the right, no vertical scale."""
    places = [-row for row in range(len(responses))]
    axes.set_yticks(places, [_name(r) for r in responses])
    axes.set_ylim(-len(responses) + 0.55, 0.62)
    axes.tick_params(axis="y", length=0)
    axes.grid(False, axis="y")
    axes.spines["left"].set_visible(False)
    right = axes.secondary_yaxis("right")
    right.set_yticks(places, [f"RMSE\n{scale.text(r.rmse)}" for r in responses])
    right.tick_params(length=0)
    right.spines["right"].set_visible(False)


def _name(response: Response) -> str:
    mark = "" if response.provenance == "measured" else f" ({response.provenance})"
    return "\n".join(cut(line, NAME) for line in (response.model, response.view, response.record)) + mark
