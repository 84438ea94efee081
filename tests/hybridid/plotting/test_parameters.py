"""Estimates: where they are, how sharp, and what is wrong with them."""

from __future__ import annotations

import numpy as np
import pytest

from hybridid.plotting.correlation_map import correlation_map, short_names
from hybridid.plotting.parameters import parameters_plot
from hybridid.plotting.series import PlotError
from hybridid.plotting.style import new_figure


def plot_of(estimates, parameters, width=180.0):
    return parameters_plot(estimates, parameters, "identification", "measured", width)


def beside(figure):
    return [label.get_text() for label in figure.axes[1].child_axes[0].get_yticklabels()]


def test_values_are_drawn_over_their_scale_with_the_guess(estimate, parameters):
    values = plot_of({"model": estimate()}, parameters).figure.axes[0]
    guess = next(line for line in values.get_lines() if line.get_label() == "guess")
    assert np.transpose(guess.get_data()).tolist() == [[1, 0], [1, 1], [1, 2], [0, 3]]
    points = [c.lines[0].get_xdata()[0] for c in values.containers]
    assert points == pytest.approx([91.16 / 80, 190.2 / 150, 22.18 / 9, -3.36 / 30])


def test_intervals_are_95_percent_and_written_out(estimate, parameters):
    figure = plot_of({"model": estimate(std=0.5)}, parameters).figure
    assert beside(figure) == ["91.16 ± 0.18 kg", "190.20 ± 0.37 N·s/m", "22.180 ± 0.043 N", "−3.36 ± 0.98 N"]
    percents = sorted(float(line.get_xdata()[0]) for line in figure.axes[1].get_lines())
    assert percents == pytest.approx([0.196, 0.196, 0.196, 100 * 1.96 * 0.5 / 3.36], rel=1e-3)
    low, high = figure.axes[1].get_xlim()
    assert low < percents[0] < percents[-1] < high


@pytest.mark.parametrize(
    ("change", "text"),
    [
        ({"at_bound": True}, "−3.3600 ± 0.0066 N, at bound"),
        ({"identifiable": False, "std": np.inf}, "−3.36 ± ? N, not identifiable"),
        ({"std": np.nan}, "−3.36 ± ? N"),
        ({"unit": "1"}, "−3.3600 ± 0.0066"),
    ],
)
def test_what_is_wrong_is_said(estimate, parameters, change, text):
    figure = plot_of({"model": estimate(**change)}, parameters).figure
    assert beside(figure)[-1] == text
    face = figure.axes[0].containers[-1].lines[0].get_markerfacecolor()
    assert (face == "white") == ("not identifiable" in text)


def test_several_models_keep_apart_and_each_has_its_map(estimate, parameters):
    figure = plot_of({"a": estimate(), "b": estimate((80.0, 150.0, 9.0, 0.1))}, parameters).figure
    heights = [c.lines[0].get_ydata()[0] for c in figure.axes[0].containers]
    assert len(set(heights)) == 8
    assert [axes.get_title(loc="left") for axes in figure.axes[2:4]] == ["correlation: a", "correlation: b"]
    cells = [text.get_text() for text in figure.axes[2].texts]
    assert cells[:4] == ["1.00", "0.90", "−0.40", "0.10"]


def test_short_names_stay_unique():
    names = ["M", "carriage.viscous.f_v", "load.viscous.f_v", "carriage.coulomb.f_c"]
    assert short_names(names) == ["M", "carriage.viscous.f_v", "load.viscous.f_v", "f_c"]


def test_nothing_estimated_is_refused(parameters):
    with pytest.raises(PlotError, match="parameters of identification: no estimate"):
        plot_of({}, parameters)


@pytest.mark.parametrize(("count", "written"), [(6, True), (7, False)])
def test_the_cells_hold_numbers_or_a_scale_of_colours_stands_beside(count, written):
    figure = new_figure(88.0, 60.0, "correlations", "measured")
    axes = figure.subplots()
    correlation_map(axes, [f"p{k}" for k in range(count)], np.eye(count), "gray box", 0.5)
    assert len(axes.texts) == (count**2 if written else 0)
    assert len(axes.child_axes) == (0 if written else 1)
