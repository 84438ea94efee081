"""Figure: models against data over the whole record, enlarged where the error is largest."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes

from hybridid.plotting.axes import (
    Scale,
    draw,
    frame,
    frame_data,
    leaves,
    name_y,
    scale_for,
    shade,
    time_scale,
)
from hybridid.plotting.legends import USABLE, legend_on_top
from hybridid.plotting.lettering import shorten
from hybridid.plotting.looks import DATA, FOCUS, SOFT_INK, look
from hybridid.plotting.series import Response, masked_words, one_output
from hybridid.plotting.style import DOUBLE_COLUMN, Plot, new_figure, styled
from hybridid.quantities import number, with_unit

ZOOM = 0.08  # part of the record in the lower, enlarged panel
Limits = tuple[float, float]


@styled
def comparison_plot(responses: Sequence[Response], width: float = DOUBLE_COLUMN) -> Plot:
    """The measured output with every model's response; below, the largest error enlarged.

    Raises:
        PlotError: if there is no response, or they show different outputs or records.
    """
    whole = one_output(responses)
    figure = new_figure(width, 92, whole.title, whole.provenance)
    overview, zoom = figure.subplots(2, 1)
    time = time_scale(whole.time)
    scale = scale_for(whole.output, whole.unit, whole.measured)
    error = scale_for("error", whole.unit, np.array([_readable([r.rmse for r in responses])]))
    worst, moment, size = _worst(responses)
    span, window = (float(whole.time[0]), float(whole.time[-1])), _window(whole, moment)
    limits = frame_data(whole.measured, [r.predicted for r in responses])
    labels = [_label(r, error, leaves(r.predicted, limits)) for r in responses]
    for axes, part in ((overview, span), (zoom, window)):
        _draw_part(axes, whole, responses, labels, part, time, scale)
    overview.set_ylim(limits[0] * scale.factor, limits[1] * scale.factor)
    overview.axvspan(window[0] * time.factor, window[1] * time.factor, color=FOCUS, zorder=0)
    legend_on_top(figure, overview.get_legend_handles_labels()[0])
    zoom.set_facecolor(FOCUS)
    zoom.set_ylim(*_zoom_limits(responses, window, limits, scale.factor))
    zoom.axvline(moment * time.factor, color=SOFT_INK, linewidth=0.6, linestyle=(0, (1, 1.5)), zorder=1)
    largest = scale_for("error", whole.unit, np.array([size])).text(size)
    where = f"{largest} at {with_unit(number(moment * time.factor), time.unit)}"
    shorten(zoom.set_title(worst.model), USABLE, f": largest error, {where} (dotted line)")
    zoom.set_xlabel(time.label)
    figure.align_ylabels()
    caption = (
        f"Output {whole.output} of {whole.record} ({whole.provenance}) and of "
        f"{', '.join(f'{r.model} ({r.view})' for r in responses)}; below, enlarged, the largest "
        f"error, {where}{masked_words(whole)}."
    )
    return Plot(figure, "comparison", caption, whole.provenance)


def _draw_part(
    axes: Axes,
    whole: Response,
    responses: Sequence[Response],
    labels: Sequence[str],
    part: Limits,
    time: Scale,
    scale: Scale,
) -> None:
    """Data and models between two times, thinned for that part alone."""
    inside = _inside(whole, part)
    x, y = whole.time[inside] * time.factor, whole.measured[inside] * scale.factor
    draw(axes, x, y, DATA, whole.provenance, whole.holes[:, 1] * time.factor)
    shade(axes, whole.holes, time.factor)
    for index, (response, label) in enumerate(zip(responses, labels, strict=True)):
        inside = _inside(response, part)
        x, y = response.time[inside] * time.factor, response.predicted[inside] * scale.factor
        draw(axes, x, y, look(index), label, response.breaks * time.factor)
    axes.set_xlim(part[0] * time.factor, part[1] * time.factor)
    name_y(axes, scale)


def _label(response: Response, error: Scale, outside: bool) -> str:
    label = f"{response.model}, {response.view}: RMSE {error.text(response.rmse)}"
    return label + " (leaves the axis)" if outside else label


def _readable(values: Sequence[float]) -> float:
    """The largest value within three decades of the smallest, so that a diverged model does not count."""
    found = [v for v in values if np.isfinite(v) and v > 0]
    return max((v for v in found if v < 1e3 * min(found)), default=0.0)


def _worst(responses: Sequence[Response]) -> tuple[Response, float, float]:
    """The response with the largest finite error, its time and its size."""
    sizes = [np.nan_to_num(np.abs(r.error), nan=0.0, posinf=0.0) for r in responses]
    worst = max(range(len(responses)), key=lambda k: float(sizes[k].max()))
    at = int(sizes[worst].argmax())
    return responses[worst], float(responses[worst].time[at]), float(sizes[worst][at])


def _window(response: Response, moment: float) -> Limits:
    start, stop = float(response.time[0]), float(response.time[-1])
    length = ZOOM * (stop - start)
    low = min(max(moment - length / 2, start), stop - length)
    return low, low + length


def _inside(response: Response, part: Limits) -> np.ndarray:
    return (response.time >= part[0]) & (response.time <= part[1])


def _zoom_limits(responses: Sequence[Response], window: Limits, limits: Limits, factor: float) -> Limits:
    parts = []
    for response in responses:
        inside = _inside(response, window)
        parts += [response.measured[inside], np.clip(response.predicted[inside], *limits)]
    low, high = frame(parts)
    return low * factor, high * factor
