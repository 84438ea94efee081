"""Figure: learned efforts or flows at a port, a bound on what an effect of one variable can explain."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from matplotlib.axes import Axes
from matplotlib.lines import Line2D

from hybridid.declarations import PortKind
from hybridid.plotting.axes import Array, frame, name_y, scale_for
from hybridid.plotting.legends import legend_on_top
from hybridid.plotting.looks import SOFT_INK, look
from hybridid.plotting.series import PlotError
from hybridid.plotting.style import DOUBLE_COLUMN, Plot, new_figure, styled
from hybridid.quantities import percent

COLUMNS = 3
PANEL = 46.0  # mm
TITLE = 4.0  # mm a line
LARGEST = 40.0  # area in pt² of the dot at the point with the most samples


@dataclass(frozen=True)
class LearnedCurve:
    """Effort (m,) in ``unit`` learned over ``over`` (velocity, position, load; ``at`` (m,) in ``over_unit``),
    or flow by the ``kind`` of the port, beside ``model``, the ``samples`` (m,) that saw it, and the share of
    held-out RMSE that it takes away. ``ended_early``: the fit promised little and was not carried to its
    end. With a ``factor`` (velocity, drive) the curve is what multiplies it."""

    model: str
    over: str
    at: Array
    effort: Array
    samples: Array
    unit: str
    over_unit: str
    gain: float
    ended_early: bool = False
    kind: PortKind = "effort"
    factor: str = ""

    @property
    def taken(self) -> str:
        """The error that it takes away, in words."""
        return self.share_taken(0, " less error")

    def share_taken(self, places: int, of: str = "") -> str:
        """The share of the error; zero for a curve that learned only noise."""
        return f"{percent(max(self.gain, 0), places)}{of}{' (ended early)' if self.ended_early else ''}"


@styled
def ceiling_plot(
    port: str, curves: Sequence[LearnedCurve], judged: str, provenance: str, width: float = DOUBLE_COLUMN
) -> Plot:
    """One panel for each variable: the effort or flow that a free curve of that variable adds to each model.

    Raises:
        PlotError: if there is no curve.
    """
    if not curves:
        raise PlotError(f"ceiling at {port}: no curve to draw; give at least one")
    kind, factor = curves[0].kind, curves[0].factor
    variables = list(dict.fromkeys(curve.over for curve in curves))
    models = list(dict.fromkeys(curve.model for curve in curves))
    columns = min(COLUMNS, len(variables))
    rows = -(-len(variables) // columns)
    height = 22 + rows * (TITLE * len(models) + PANEL)
    times = f", times {factor}," if factor else ""
    figure = new_figure(width, height, f"learned {kind} at {port}, {judged}", provenance)
    grid = figure.subplots(rows, columns, sharey=True, squeeze=False)
    panels = grid.ravel()[: len(variables)]
    for unused in grid.ravel()[len(variables) :]:
        unused.remove()
    learned = f"learned {kind} over {factor}" if factor else f"learned {kind}"
    effort = scale_for(learned, curves[0].unit, *(curve.effort for curve in curves))
    lines: dict[str, Line2D] = {}
    for axes, over in zip(panels, variables, strict=True):
        shown = [curve for curve in curves if curve.over == over]
        lines |= _panel(axes, shown, models, effort.factor)
        axes.set_title("\n".join(f"{curve.model}: {curve.taken}" for curve in shown))
    for first in grid[:, 0]:
        name_y(first, effort)
    panels[0].set_ylim(frame([curve.effort * effort.factor for curve in curves]))
    legend_on_top(figure, [lines[model] for model in models])
    found = "; ".join(f"over {c.over} beside the {c.model} {c.share_taken(1)}" for c in curves)
    caption = (
        f"{kind.capitalize()} at {port} ({provenance}) learned as a free curve of one variable{times} fitted "
        f"in simulation beside everything else, and how much of the error it takes away, {judged}: {found}. "
        "No effect of that variable alone can do more, up to the curve's resolution: a pitch much finer than "
        "the curve does not show. Dots are as large as the record dwells there long: between them little "
        "holds the curve."
    )
    return Plot(figure, f"ceiling_{port}", caption, provenance)


def _panel(
    axes: Axes, curves: Sequence[LearnedCurve], models: Sequence[str], factor: float
) -> dict[str, Line2D]:
    scale = scale_for(curves[0].over, curves[0].over_unit, *(curve.at for curve in curves))
    axes.axhline(0.0, color=SOFT_INK, linewidth=0.5, zorder=1)
    axes.axvline(0.0, color=SOFT_INK, linewidth=0.5, zorder=1)
    lines: dict[str, Line2D] = {}
    for curve in curves:
        style = look(models.index(curve.model))
        lines[curve.model] = axes.plot(
            curve.at * scale.factor, curve.effort * factor, label=f"beside the {curve.model}",
            color=style.colour, linestyle=style.dashes, linewidth=0.7, zorder=style.above,
        )[0]  # fmt: skip
        axes.scatter(
            curve.at * scale.factor, curve.effort * factor, LARGEST * curve.samples / curve.samples.max(),
            color=style.colour, linewidths=0, zorder=style.above + 1,
        )  # fmt: skip
    axes.set_xlim(frame([curve.at * scale.factor for curve in curves], 0.02))
    axes.set_xlabel(scale.label)
    return lines
