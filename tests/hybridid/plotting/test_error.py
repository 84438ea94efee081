"""The error over time: a panel a view, boundaries where horizons begin."""

from __future__ import annotations

import numpy as np
import pytest

from hybridid.plotting.error import error_plot


def boundaries(axes):
    return [c for c in axes.collections if c.get_gid() == "boundaries"]


def test_each_view_has_its_panel_and_only_horizons_have_boundaries(responses):
    free, horizons = error_plot(responses).figure.axes
    assert (free.get_title(loc="left"), horizons.get_title(loc="left")) == ("free run", "horizons of 1 s")
    assert boundaries(free) == []
    (lines,) = boundaries(horizons)
    assert [segment[0][0] for segment in lines.get_segments()] == pytest.approx(range(25))


def test_what_is_drawn_is_recorded_minus_model_in_the_axis_unit(responses):
    free = error_plot(responses).figure.axes[0]
    line = free.get_lines()[0]
    assert free.get_ylabel() == "error [mm]"
    assert np.nanmax(line.get_ydata()) == pytest.approx(1e3 * responses[0].error.max())
    assert np.nanmin(line.get_ydata()) == pytest.approx(1e3 * responses[0].error.min())


def test_a_model_keeps_its_look_in_every_panel(responses):
    by_panel = [
        {
            line.get_label().split(",")[0]: line.get_color()
            for line in axes.get_lines()
            if "RMSE" in line.get_label()
        }
        for axes in error_plot(responses).figure.axes
    ]
    assert by_panel[0] == by_panel[1]
    assert len(set(by_panel[0].values())) == 2


def test_lines_break_at_the_boundaries(responses):
    horizons = error_plot(responses).figure.axes[1]
    assert np.isnan(horizons.get_lines()[0].get_ydata()).sum() == 24
