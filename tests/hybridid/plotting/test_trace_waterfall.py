"""The waterfall shows the error that is left, and pale what each effect took of it."""

from __future__ import annotations

import pytest

from hybridid.plotting.series import PlotError
from hybridid.plotting.trace_waterfall import Level, waterfall_plot


def test_each_row_is_as_long_as_the_error_that_is_left():
    levels = [Level("declared model", 11.8e-3), Level("+ joint.centrifugal_brake", 99.5e-6)]
    plot = waterfall_plot(levels, 1e-4, "angle", "rad", "held-out horizons of 1 s", "simulated")
    (axes,) = plot.figure.axes
    solid = [bar for bar in axes.patches if bar.get_alpha() is None]
    (pale,) = (bar for bar in axes.patches if bar.get_alpha() is not None)
    assert [bar.get_width() for bar in solid] == pytest.approx([11.8, 0.0995, 0.1])
    assert pale.get_width() == pytest.approx(11.8)
    said = [text.get_text() for text in axes.texts]
    assert said == ["11.8 mrad", "99.5 µrad  (−99 %)", "100 µrad"]
    assert "+ joint.centrifugal_brake 99.5 µrad; noise floor of the sensor 100 µrad" in plot.caption


def test_without_a_level_nothing_is_drawn():
    with pytest.raises(PlotError, match="no level to draw"):
        waterfall_plot([], 1e-4, "angle", "rad", "", "simulated")
