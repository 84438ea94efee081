"""Figure: a model under the control law that ran the machine, outputs and control effort beside the recorded
ones, each with its error."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes

from hybridid.plotting.axes import Scale, draw, frame, frame_data, leaves, name_y, scale_for, time_scale
from hybridid.plotting.legends import legend_above
from hybridid.plotting.looks import DATA, SOFT_INK, look
from hybridid.plotting.series import PlotError, Response, one_output
from hybridid.plotting.style import DOUBLE_COLUMN, Plot, new_figure, styled


@styled
def loop_plot(signals: Sequence[Sequence[Response]], width: float = DOUBLE_COLUMN) -> Plot:
    """For each signal, an output or a command: recorded and simulated over time, then their difference.

    ``signals`` holds the responses of every model to one record, signal by signal.

    Raises:
        PlotError: if there is no signal, or the responses of one show different signals or records.
    """
    if not signals:
        raise PlotError("no signal in the loop to plot; give at least one")
    each = [one_output(responses) for responses in signals]
    first, time = each[0], time_scale(each[0].time)
    figure = new_figure(width, 18 + 50 * len(each), f"{first.record} · in the loop", first.provenance)
    rows = figure.subplots(2 * len(each), 1, sharex=True, height_ratios=[3, 2] * len(each))
    for whole, responses, above, below in zip(each, signals, rows[::2], rows[1::2], strict=True):
        _draw_signal(above, whole, responses, time)
        _draw_error(below, whole, responses, time)
    rows[-1].set_xlabel(time.label)
    rows[0].set_xlim(first.time[0] * time.factor, first.time[-1] * time.factor)
    figure.align_ylabels()
    models = ", ".join(r.model for r in signals[0])
    caption = (
        f"Record {first.record} ({first.provenance}) and {models} under the controller's law: "
        f"{', '.join(w.output for w in each)}; below each, recorded minus simulated."
    )
    return Plot(figure, "loop", caption, first.provenance)


def _draw_signal(axes: Axes, whole: Response, responses: Sequence[Response], time: Scale) -> None:
    scale = scale_for(whole.output, whole.unit, whole.measured)
    error = scale_for("error", whole.unit, *(r.error for r in responses))
    limits = frame_data(whole.measured, [r.predicted for r in responses])
    draw(axes, whole.time * time.factor, whole.measured * scale.factor, DATA, whole.provenance)
    for index, one in enumerate(responses):
        outside = " (leaves the axis)" if leaves(one.predicted, limits) else ""
        label = f"{one.model}: RMSE {error.text(one.rmse)}{outside}"
        draw(axes, one.time * time.factor, one.predicted * scale.factor, look(index), label)
    axes.set_ylim(limits[0] * scale.factor, limits[1] * scale.factor)
    name_y(axes, scale)
    legend_above(axes)


def _draw_error(axes: Axes, whole: Response, responses: Sequence[Response], time: Scale) -> None:
    scale = scale_for("error", whole.unit, *(r.error for r in responses))
    for index, one in enumerate(responses):
        draw(axes, one.time * time.factor, one.error * scale.factor, look(index), one.model)
    axes.axhline(0.0, color=SOFT_INK, linewidth=0.5, zorder=1)
    axes.set_ylim(frame([r.error * scale.factor for r in responses] + [np.zeros(1)]))
    name_y(axes, scale)
