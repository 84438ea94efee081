"""Figure: autocorrelation of the residual and its cross-correlation with the inputs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes

from hybridid.plotting.axes import Array, Scale, draw, frame, name_y, scale_for
from hybridid.plotting.lettering import shorten
from hybridid.plotting.looks import BLUE, SKY, SOFT_INK, Look
from hybridid.plotting.style import DOUBLE_COLUMN, Plot, is_wide, new_figure, styled
from hybridid.quantities import percent, probability
from hybridid.validation.residual_tests import LEVEL, ResidualTests

STEMS = 80  # largest number of lags that are drawn as stems


@dataclass(frozen=True)
class _Correlation:
    """A correlation function over ``lags`` in s, and the limit of a white, independent series."""

    name: str
    lags: Array
    values: Array
    band: float

    @property
    def outside(self) -> float:
        """Percentage of the values outside the band, without the autocorrelation's 1 at lag zero."""
        counted = self.values if self.lags[0] < 0 else self.values[1:]
        return 100 * float(np.mean(np.abs(counted) > self.band)) if len(counted) else 0.0


@styled
def residual_correlation_plot(model: str, tests: ResidualTests, width: float = DOUBLE_COLUMN) -> Plot:
    """Autocorrelation of ``model``'s residual, and its cross-correlation with each input.

    The residual of a complete model is white (its autocorrelation is within the band) and
    uncorrelated with the inputs. Source: Ljung (1999), System Identification, sec. 16.6.
    """
    shown = [_Correlation("autocorrelation", tests.lags, tests.autocorrelation, tests.band)]
    for name, values in tests.cross_correlation.items():
        title = f"cross-correlation with {name.replace('_', ' ')}"
        shown.append(_Correlation(title, tests.input_lags, values, tests.input_bands[name]))
    columns = 2 if is_wide(width) and len(shown) > 1 else 1
    rows = -(-len(shown) // columns)
    title = f"{tests.record} · {tests.output.replace('_', ' ')} residual, {model}"
    figure = new_figure(width, 10 + 46 * rows, title, tests.provenance)
    panels = list(figure.subplots(rows, columns, squeeze=False).flat)
    time = scale_for("lag", "s", *(c.lags for c in shown))
    for axes, correlation in zip(panels, shown, strict=False):
        _panel(axes, correlation, time, 0.9 / columns)
    for axes in panels[len(shown) :]:
        axes.remove()
    return Plot(figure, "residual_correlation", _caption(model, tests, shown), tests.provenance)


def _panel(axes: Axes, correlation: _Correlation, time: Scale, room: float) -> None:
    lags, values = correlation.lags * time.factor, correlation.values
    band = (-correlation.band, correlation.band)
    axes.axhspan(*band, color=SKY, alpha=0.35, linewidth=0, zorder=1, gid="band")
    axes.axhline(0.0, color=SOFT_INK, linewidth=0.5, zorder=1)
    if len(lags) <= STEMS:
        axes.vlines(lags, 0, values, color=BLUE, linewidth=0.7, zorder=3)
        axes.plot(lags, values, "o", color=BLUE, markersize=2.0, zorder=3)
    else:
        draw(axes, lags, values, Look(BLUE), correlation.name)
    beyond = f": {correlation.outside:.0f} % outside the {percent(LEVEL)} band"
    shorten(axes.set_title(correlation.name), room, beyond)
    axes.set_xlim(frame([lags], 0.015))
    axes.set_ylim(frame([values, np.array(band)]))
    axes.set_xlabel(time.label)
    name_y(axes, Scale("correlation", 1.0, "–"))


def _caption(model: str, tests: ResidualTests, shown: Sequence[_Correlation]) -> str:
    return (
        f"Residual of {model}, {tests.output} of {tests.record} ({tests.provenance}): "
        f"{', '.join(c.name for c in shown)}, with the {percent(LEVEL)} band of a white, independent "
        f"residual; Ljung-Box test of whiteness: p {probability(tests.p_white, '= ')}."
    )
