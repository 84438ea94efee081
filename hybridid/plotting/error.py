"""Figure: the error over time, one panel a view, with the horizons' boundaries."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes

from hybridid.plotting.axes import Scale, draw, frame, name_y, scale_for, shade, time_scale
from hybridid.plotting.legends import legend_above
from hybridid.plotting.looks import SOFT_INK, look
from hybridid.plotting.series import Response, masked_words, one_output
from hybridid.plotting.style import DOUBLE_COLUMN, Plot, new_figure, styled


@styled
def error_plot(responses: Sequence[Response], width: float = DOUBLE_COLUMN) -> Plot:
    """Recorded minus model over time. A model has the same look in every panel.

    Raises:
        PlotError: if there is no response, or they show different outputs or records.
    """
    whole = one_output(responses)
    time = time_scale(whole.time)
    views = list(dict.fromkeys(r.view for r in responses))
    models = list(dict.fromkeys(r.model for r in responses))
    figure = new_figure(width, 18 + 36 * len(views), f"{whole.title} error", whole.provenance)
    rows = figure.subplots(len(views), 1, sharex=True, squeeze=False)[:, 0]
    for axes, view in zip(rows, views, strict=True):
        shown = [r for r in responses if r.view == view]
        scale = scale_for("error", whole.unit, *(r.error for r in shown))
        for response in shown:
            label = f"{response.model}, RMSE {scale.text(response.rmse)}"
            style = look(models.index(response.model))
            x, y = response.time * time.factor, response.error * scale.factor
            draw(axes, x, y, style, label, response.breaks * time.factor)
        shade(axes, whole.holes, time.factor)
        _dress(axes, shown, scale, view, time.factor)
    rows[-1].set_xlabel(time.label)
    rows[0].set_xlim(whole.time[0] * time.factor, whole.time[-1] * time.factor)
    figure.align_ylabels()
    return Plot(figure, "error", _caption(whole, models, views, responses), whole.provenance)


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


def _caption(whole: Response, models: list[str], views: list[str], responses: Sequence[Response]) -> str:
    dotted = "; dotted lines: where each horizon starts anew" if any(len(r.starts) for r in responses) else ""
    return (
        f"Error (recorded minus model) of {whole.output} on {whole.record} ({whole.provenance}): "
        f"{', '.join(models)}, {' and '.join(views)}{dotted}{masked_words(whole)}."
    )
