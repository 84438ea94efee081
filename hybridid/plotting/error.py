"""Figure: the error over time, one panel a view, with the horizons' boundaries."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes

from hybridid.plotting.axes import Scale, draw, frame, legend_above, name_y, scale_for, time_scale
from hybridid.plotting.looks import SOFT_INK, look
from hybridid.plotting.series import Response, Subject, some_responses
from hybridid.plotting.style import DOUBLE_COLUMN, Plot, new_figure, styled


@styled
def error_plot(subject: Subject, responses: Sequence[Response], width: float = DOUBLE_COLUMN) -> Plot:
    """Measured minus model over time. A model keeps its look from panel to panel.

    Raises:
        PlotError: if there is no response.
    """
    time = time_scale(some_responses(subject, responses)[0].time)
    views = list(dict.fromkeys(r.view for r in responses))
    models = list(dict.fromkeys(r.model for r in responses))
    figure = new_figure(width, 18 + 36 * len(views), f"{subject.title} error", subject.provenance)
    rows = figure.subplots(len(views), 1, sharex=True, squeeze=False)[:, 0]
    for axes, view in zip(rows, views, strict=True):
        shown = [r for r in responses if r.view == view]
        scale = scale_for("error", subject.unit, *(r.error for r in shown))
        for response in shown:
            label = f"{response.model}, RMSE {scale.text(response.rmse)}"
            style = look(models.index(response.model))
            x, y = response.time * time.factor, response.error * scale.factor
            draw(axes, x, y, style, label, response.starts * time.factor)
        _dress(axes, shown, scale, view, time.factor)
    rows[-1].set_xlabel(time.label)
    rows[0].set_xlim(responses[0].time[0] * time.factor, responses[0].time[-1] * time.factor)
    figure.align_ylabels()
    return Plot(figure, "error", _caption(subject, models, views, responses), subject.provenance)


def _dress(axes: Axes, shown: Sequence[Response], scale: Scale, view: str, to_time: float) -> None:
    starts = np.unique(np.concatenate([r.starts for r in shown])) * to_time
    if len(starts):
        axes.grid(False, axis="x")
        axes.vlines(
            starts, 0, 1, transform=axes.get_xaxis_transform(), gid="boundaries",
            color=SOFT_INK, linewidth=0.35, linestyle=(0, (1, 2)), zorder=1,
        )  # fmt: skip
    axes.axhline(0.0, color=SOFT_INK, linewidth=0.5, zorder=1)
    axes.set_ylim(frame([r.error * scale.factor for r in shown] + [np.zeros(1)]))
    name_y(axes, scale)
    legend_above(axes, title=view)


def _caption(subject: Subject, models: list[str], views: list[str], responses: Sequence[Response]) -> str:
    dotted = "; dotted lines: where each horizon starts anew" if any(len(r.starts) for r in responses) else ""
    return (
        f"Error (measured minus model) of {subject.quantity} on {subject.record} ({subject.provenance}): "
        f"{', '.join(models)}, {' and '.join(views)}{dotted}."
    )
