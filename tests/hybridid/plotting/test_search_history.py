"""The course of a search as a figure."""

from __future__ import annotations

import math

import pytest

from hybridid.plotting.search_history import Tried, history_plot
from hybridid.plotting.series import PlotError

TRIED = (
    Tried(0, 0.9, False, False),
    Tried(1, 0.8, True, False),
    Tried(2, 0.5, False, False),
    Tried(3, 0.52, False, True),
    Tried(5, math.inf, False, False),
    Tried(6, 0.95, True, False),
)


def lines():
    figure = history_plot(TRIED, "carriage", "simulated").figure
    (axes,) = figure.axes
    return axes, {line.get_label(): line for line in axes.get_lines()}


def test_lowest_error_so_far_falls_and_reaches_the_last_trial():
    _, drawn = lines()
    lowest = drawn["lowest so far"]
    assert list(lowest.get_xdata()) == [0, 2, 3, 6]
    assert list(lowest.get_ydata()) == [90, 50, 50, 50]


def test_what_was_pruned_or_chosen_is_marked():
    axes, drawn = lines()
    assert list(drawn["pruned"].get_xdata()) == [1, 6]
    assert list(drawn["to its end"].get_xdata()) == [0, 2, 3], "what diverged has no place"
    assert (list(drawn["chosen"].get_xdata()), list(drawn["chosen"].get_ydata())) == ([3], [52])
    assert axes.get_ylabel().endswith("[%]")


def test_nothing_to_show():
    with pytest.raises(PlotError, match="no trial has an error"):
        history_plot([Tried(0, math.nan, False, False)], "carriage", "measured")
