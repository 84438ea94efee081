"""Scales, limits and legends."""

from __future__ import annotations

import numpy as np
import pytest

from hybridid.plotting.axes import (
    frame,
    frame_data,
    leaves,
    legend_above,
    legend_on_top,
    scale_for,
    time_scale,
)
from hybridid.plotting.style import context, new_figure


def test_a_scale_reads_well_and_ignores_what_is_not_finite():
    scale = scale_for("motor_force", "N", np.array([1.0, np.inf, -2500.0]), np.array([np.nan]))
    assert (scale.label, scale.factor) == ("motor force [kN]", pytest.approx(1e-3))


@pytest.mark.parametrize(
    ("value", "text"),
    [(0.00259, "2.59 mm"), (-0.0001, "−0.100 mm"), (12.3456, "12346 mm"), (np.nan, "not finite")],
)
def test_numbers_keep_the_scale_s_unit(value, text):
    assert scale_for("error", "m", np.array([0.01])).text(value) == text


def test_short_records_are_in_milliseconds():
    assert time_scale(np.linspace(5.0, 5.05, 10)).label == "time [ms]"
    assert time_scale(np.linspace(0, 5000, 10)).label == "time [s]"


def test_limits_hold_everything_and_never_collapse():
    low, high = frame([np.array([0.0, 10.0]), np.array([np.nan, -2.0])])
    assert (low, high) == (pytest.approx(-2.72), pytest.approx(10.72))
    for constant in (0.0, 3.0, -3.0):
        low, high = frame([np.full(5, constant)])
        assert low < constant < high
    assert frame([np.array([np.nan])]) == (-1.0, 1.0)


def test_a_runaway_model_does_not_flatten_the_data():
    data = np.array([0.0, 1.0])
    limits = frame_data(data, [np.array([0.0, 1e9]), np.array([np.inf])])
    assert limits == (pytest.approx(-0.6), pytest.approx(1.6))
    assert leaves(np.array([0.0, 1e9]), limits)
    assert leaves(np.array([0.5, np.nan]), limits)
    assert not leaves(data, limits)


def legend_texts(labels, place):
    with context():
        figure = new_figure(88, 60, "a", "measured")
        axes = figure.subplots()
        handles = [axes.plot([0, 1], [0, k], label=label)[0] for k, label in enumerate(labels)]
        place(figure, axes, handles)
        figure.draw_without_rendering()
        legend = axes.get_legend() or figure.legends[0]
        return legend, figure, axes


@pytest.mark.parametrize(
    "place",
    [
        lambda figure, axes, handles: legend_on_top(figure, handles),
        lambda f, axes, h: legend_above(axes, "free run"),
    ],
)
@pytest.mark.parametrize("labels", [["short"], ["name"] * 9, ["a very long name of a model " * 6] * 3])
def test_legends_keep_inside_the_figure_and_above_the_axes(labels, place):
    legend, figure, axes = legend_texts(labels, place)
    box = legend.get_window_extent()
    assert len(legend.get_texts()) == len(labels)
    assert box.x0 >= -1
    assert box.x1 <= figure.bbox.x1 + 1
    assert box.y0 >= axes.get_window_extent().y1 - 1
    assert axes.get_window_extent().height > 0.3 * figure.bbox.height


def test_short_labels_share_a_row_and_long_ones_are_cut():
    def place(figure, axes, handles):
        legend_on_top(figure, handles)

    short, _, _ = legend_texts(["one", "two", "three"], place)
    assert len({round(text.get_window_extent().y0) for text in short.get_texts()}) == 1
    long, _, _ = legend_texts(["a very long name of a model " * 6], place)
    assert long.get_texts()[0].get_text().endswith("…")
