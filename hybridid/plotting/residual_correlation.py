"""Figure: what is left in the residual: its autocorrelation and its correlation with the inputs."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes

from hybridid.plotting.axes import Array, Scale, draw, frame, name_y, scale_for
from hybridid.plotting.looks import BLUE, SKY, SOFT_INK, Look
from hybridid.plotting.series import PlotError, Subject
from hybridid.plotting.style import DOUBLE_COLUMN, Plot, is_wide, new_figure, styled

STEMS = 80  # lags up to which each is drawn as a stem of its own


@dataclass(frozen=True)
class Correlation:
    """A normalised correlation function.

    Shapes: ``lags`` (n,) in s, ``values`` (n,) in [-1, 1]. ``band`` is the half-width of the
    interval that holds the part ``confidence`` of the values of an unrelated series.
    """

    lags: Array
    values: Array
    band: float
    confidence: float = 0.99

    def __post_init__(self) -> None:
        if len(self.lags) != len(self.values):
            raise PlotError(
                f"correlation: {len(self.lags)} lags and {len(self.values)} values; they must be as many"
            )

    def outside(self, without_zero: bool) -> float:
        """Part of the values outside the band; lag zero of an autocorrelation does not count."""
        counted = self.values[self.lags != 0] if without_zero else self.values
        return float(np.mean(np.abs(counted) > self.band)) if len(counted) else 0.0


@styled
def residual_correlation_plot(
    subject: Subject,
    model: str,
    autocorrelation: Correlation,
    with_inputs: Mapping[str, Correlation],
    ljung_box_p: float,
    width: float = DOUBLE_COLUMN,
) -> Plot:
    """Autocorrelation of ``model``'s residual, and its cross-correlation with each input by name.

    A residual that holds nothing more to model is white (its autocorrelation stays in the
    band) and unrelated to the inputs. Source: Ljung (1999), System Identification, sec. 16.6.
    """
    named = {"autocorrelation": autocorrelation}
    named |= {f"cross-correlation with {name}": c for name, c in with_inputs.items()}
    columns = 2 if is_wide(width) and len(named) > 1 else 1
    rows = -(-len(named) // columns)
    figure = new_figure(width, 10 + 46 * rows, f"{subject.title} residual, {model}", subject.provenance)
    panels = list(figure.subplots(rows, columns, squeeze=False).flat)
    time = scale_for("lag", "s", *(c.lags for c in named.values()))
    for axes, (name, correlation) in zip(panels, named.items(), strict=False):
        _panel(axes, name, correlation, time, is_auto=correlation is autocorrelation)
    for axes in panels[len(named) :]:
        axes.remove()
    return Plot(
        figure, "residual_correlation", _caption(subject, model, named, ljung_box_p), subject.provenance
    )


def _panel(axes: Axes, name: str, correlation: Correlation, time: Scale, is_auto: bool) -> None:
    lags, values = correlation.lags * time.factor, correlation.values
    band = (-correlation.band, correlation.band)
    axes.axhspan(*band, color=SKY, alpha=0.35, linewidth=0, zorder=1, gid="band")
    axes.axhline(0.0, color=SOFT_INK, linewidth=0.5, zorder=1)
    if len(lags) <= STEMS:
        axes.vlines(lags, 0, values, color=BLUE, linewidth=0.7, zorder=3)
        axes.plot(lags, values, "o", color=BLUE, markersize=2.0, zorder=3)
    else:
        draw(axes, lags, values, Look(BLUE), name)
    beyond = correlation.outside(without_zero=is_auto)
    axes.set_title(f"{name}: {100 * beyond:.0f} % outside the {100 * correlation.confidence:.0f} % band")
    axes.set_xlim(frame([lags], 0.015))
    axes.set_ylim(frame([values, np.array(band)]))
    axes.set_xlabel(time.label)
    name_y(axes, Scale("correlation", 1.0, "–"))


def _caption(subject: Subject, model: str, named: dict[str, Correlation], p: float) -> str:
    others = [name for name in named if name != "autocorrelation"]
    probability = "p < 0.001" if p < 1e-3 else f"p = {p:.3f}"
    return (
        f"Residual of {model}, {subject.quantity} of {subject.record} ({subject.provenance}): autocorrelation"
        f"{''.join(f', {name}' for name in others)}, with the band of an unrelated series; "
        f"Ljung-Box test of whiteness: {probability}."
    )
