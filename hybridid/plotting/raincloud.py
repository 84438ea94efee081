"""Figure: the distributions of the errors of several models on several records."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from scipy.stats import gaussian_kde

from hybridid.plotting.axes import Array, Scale, frame, scale_for
from hybridid.plotting.looks import INK, SOFT_INK, look
from hybridid.plotting.series import PlotError
from hybridid.plotting.style import DOUBLE_COLUMN, Plot, new_figure, styled

ROW = 15.0  # mm
KERNEL_SAMPLES = 3000  # evenly over the record; more does not change the density
DROPS = 350
CLOUD, BOX, RAIN = 0.42, 0.09, 0.30  # heights as parts of a row: above, on and below its line


@dataclass(frozen=True)
class ErrorSample:
    """Errors (n,) of one model on one record; ``view`` as in ``Response``."""

    model: str
    record: str
    values: Array
    view: str = "free run"
    provenance: str = "measured"

    def __post_init__(self) -> None:
        if not len(self.values) or not np.isfinite(self.values).all():
            raise PlotError(
                f"raincloud: the errors of {self.model} on {self.record} must be finite and at least one"
            )

    @property
    def rmse(self) -> float:
        return float(np.sqrt(np.mean(self.values**2)))


@styled
def raincloud_plot(
    quantity: str, unit: str, samples: Sequence[ErrorSample], width: float = DOUBLE_COLUMN
) -> Plot:
    """Half violin (kernel density), box (5, 25, 50, 75, 95 %) and a thinned scatter of every sample.

    Source: Allen et al. (2019), "Raincloud plots", Wellcome Open Research 4:63.

    Raises:
        PlotError: if there is no sample.
    """
    if not samples:
        raise PlotError(f"raincloud of {quantity}: no errors to plot; give at least one sample")
    provenance = _provenance(samples)
    models = list(dict.fromkeys(s.model for s in samples))
    scale = scale_for(f"{quantity} error", unit, *(s.values for s in samples))
    figure = new_figure(width, 18 + ROW * len(samples), f"{quantity} error".replace("_", " "), provenance)
    axes = figure.subplots()
    axes.axvline(0.0, color=SOFT_INK, linewidth=0.5, zorder=1)
    for row, sample in enumerate(samples):
        colour = look(models.index(sample.model)).colour
        _cloud(axes, -row, sample.values * scale.factor, colour)
    axes.set_xlabel(scale.label)
    axes.set_xlim(frame([s.values * scale.factor for s in samples], 0.03))
    _rows(axes, samples, scale)
    listed = ", ".join(dict.fromkeys(f"{s.record} ({s.provenance})" for s in samples))
    caption = (
        f"Errors (measured minus model) of {quantity} for {', '.join(models)} on {listed}: density, box "
        "(5, 25, 50, 75 and 95 %) and single samples, with the RMSE at the right."
    )
    return Plot(figure, "raincloud", caption, provenance)


def _provenance(samples: Sequence[ErrorSample]) -> str:
    """``measured`` only if everything is."""
    kinds = dict.fromkeys(s.provenance for s in samples)
    return " and ".join(sorted(kinds))


def _cloud(axes: Axes, base: float, values: Array, colour: str) -> None:
    thinned = values[:: max(1, len(values) // KERNEL_SAMPLES)]
    if np.ptp(thinned) > 0:
        grid = np.linspace(values.min(), values.max(), 240)
        density = gaussian_kde(thinned)(grid)
        top = base + 0.5 * BOX + 0.04 + CLOUD * density / density.max()
        axes.fill_between(grid, base + 0.5 * BOX + 0.04, top, color=colour, alpha=0.55, linewidth=0, zorder=2)
        axes.plot(grid, top, color=colour, linewidth=0.7, zorder=3)
    axes.bxp(
        [_box(values)], positions=[base], widths=BOX, orientation="horizontal", showfliers=False,
        manage_ticks=False, patch_artist=True, zorder=4,
        boxprops={"facecolor": colour, "edgecolor": INK, "linewidth": 0.5},
        medianprops={"color": "white", "linewidth": 1.2, "solid_capstyle": "butt"},
        whiskerprops={"color": INK, "linewidth": 0.6}, capprops={"linewidth": 0},
    )  # fmt: skip
    drops = values[:: max(1, len(values) // DROPS)]
    jitter = np.random.default_rng(0).uniform(0.0, 1.0, len(drops))
    below = base - 0.5 * BOX - 0.05 - RAIN * jitter
    axes.plot(drops, below, ".", color=colour, markersize=1.8, markeredgewidth=0, alpha=0.6, rasterized=True)


def _box(values: Array) -> dict[str, float]:
    quantiles = np.quantile(values, (0.05, 0.25, 0.5, 0.75, 0.95))
    return dict(zip(("whislo", "q1", "med", "q3", "whishi"), map(float, quantiles), strict=True))


def _rows(axes: Axes, samples: Sequence[ErrorSample], scale: Scale) -> None:
    """Names at the left, root mean square errors at the right, no vertical scale."""
    places = [-row for row in range(len(samples))]
    axes.set_yticks(places, [_name(s) for s in samples])
    axes.set_ylim(-len(samples) + 0.55, 0.62)
    axes.tick_params(axis="y", length=0)
    axes.grid(False, axis="y")
    axes.spines["left"].set_visible(False)
    right = axes.secondary_yaxis("right")
    right.set_yticks(places, [f"RMSE\n{scale.text(s.rmse)}" for s in samples])
    right.tick_params(length=0)
    right.spines["right"].set_visible(False)


def _name(sample: ErrorSample) -> str:
    mark = "" if sample.provenance == "measured" else f" ({sample.provenance})"
    return f"{sample.model}\n{sample.view}\n{sample.record}{mark}"
