"""Panels: what is drawn where, what is enlarged, and what is refused."""

from __future__ import annotations

import numpy as np
import pytest

from hybridid.plotting.looks import look
from hybridid.plotting.panels import DOTS, Line, Panel, panels_plot
from hybridid.plotting.series import PlotError
from hybridid.plotting.style import SINGLE_COLUMN

TIME = np.linspace(0.0, 10.0, 1001)
DATA = Line("measured", TIME, 2e-3 * np.sin(TIME), look(0))
MODEL = Line("a model", TIME, 2.2e-3 * np.sin(TIME), look(1))


def panel(lines=(DATA, MODEL), **changed):
    return Panel("one", ("time", "s"), ("position", "m"), lines, **changed)


def drawn(*panels, **layout):
    return panels_plot("panels", "record", list(panels), "Panels (measured).", "measured", **layout).figure


def test_values_come_in_the_unit_of_the_axis():
    axes = drawn(panel()).axes[0]
    assert axes.get_ylabel() == "position [mm]"
    assert axes.get_lines()[0].get_ydata().max() == pytest.approx(2.0, rel=1e-3)


def test_the_enlarged_part_shows_that_part_alone():
    whole, part = drawn(panel(focus=(2.0, 3.0))).axes
    assert whole.get_xlim() == (0.0, 10.0)
    assert part.get_xlim() == (2.0, 3.0)
    x = np.concatenate([line.get_xdata() for line in part.get_lines()])
    assert (x.min(), x.max()) == pytest.approx((2.0, 3.0))


def test_a_narrow_figure_has_one_column_and_enlarges_nothing():
    assert len(drawn(panel(focus=(2.0, 3.0)), panel(), columns=2, width=SINGLE_COLUMN).axes) == 2


def test_one_legend_names_each_label_once():
    legend = drawn(panel(), panel()).legends
    assert [text.get_text() for text in legend[0].get_texts()] == ["measured", "a model"]


def test_a_model_that_runs_away_does_not_flatten_the_data():
    away = Line("a model", TIME, np.exp(TIME), look(1))
    low, high = drawn(panel((DATA, away))).axes[0].get_ylim()
    assert -6 < low < high < 6  # mm, of data within 2 mm


def test_a_scatter_has_equal_limits_a_diagonal_and_few_dots():
    many = Line("a model", np.arange(10_000.0), np.arange(10_000.0), look(0))
    axes = drawn(Panel("one", ("y", "m"), ("y, model", "m"), [many], "scatter")).axes[0]
    assert axes.get_xlim() == axes.get_ylim()
    dots, diagonal = axes.get_lines()
    assert len(dots.get_xdata()) <= 2 * DOTS
    assert list(diagonal.get_xdata()) == list(diagonal.get_ydata())


def test_a_spectrum_ends_five_decades_below_its_highest_value():
    line = Line("measured", np.array([1.0, 10.0, 100.0]), np.array([1.0, 1e-3, 1e-12]), look(0))
    axes = drawn(Panel("one", ("frequency", "Hz"), ("amplitude", "m"), [line], "spectrum")).axes[0]
    low, high = axes.get_ylim()
    assert high / low == pytest.approx(4e5)


def test_bad_input_is_said():
    with pytest.raises(PlotError, match="panels: no panel to draw"):
        drawn()
    with pytest.raises(PlotError, match="panel one: no line to draw"):
        panel(())
    short = Line("a model", TIME, TIME[:5], look(0))
    with pytest.raises(PlotError, match="one, a model: 5 values over 1001 places"):
        panel((DATA, short))
