"""Models against data: the zoom finds the worst moment, and a runaway is said, not hidden."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from hybridid.plotting.comparison import comparison_plot


def test_the_zoom_holds_the_largest_error(responses):
    plot = comparison_plot(responses[:2])
    overview, zoom = plot.figure.axes
    first, last = zoom.get_xlim()
    assert first < 10.0 < last
    assert last - first == pytest.approx(0.08 * 24.84, rel=1e-3)
    assert overview.get_xlim() == pytest.approx((0.0, 24.84))
    largest = 1e3 * np.abs(responses[0].error).max()
    title = zoom.get_title(loc="left")
    assert title == f"symmetric friction: largest error, {largest:.3g} mm at 10 s (dotted line)"


def test_data_and_each_model_are_in_both_panels_and_the_legend_gives_the_rmse(responses):
    plot = comparison_plot(responses[:2])
    for axes in plot.figure.axes:
        drawn = [line.get_label() for line in axes.get_lines() if not line.get_label().startswith("_")]
        assert [label.split(",")[0] for label in drawn] == [
            "measured",
            "symmetric friction",
            "asymmetric viscous",
        ]
    texts = [text.get_text() for text in plot.figure.legends[0].get_texts()]
    assert f"RMSE {1e3 * responses[0].rmse:.3g} mm" in texts[1]


def test_the_zoom_is_as_fine_as_the_data(responses):
    overview, zoom = comparison_plot(responses[:1]).figure.axes
    first, last = zoom.get_xlim()
    whole, part = (axes.get_lines()[0].get_xdata() for axes in (overview, zoom))
    assert len(part) > 5 * np.count_nonzero((whole >= first) & (whole <= last))


def test_a_diverging_model_is_said_and_leaves_the_data_readable(responses):
    good = responses[0]
    runaway = replace(good, model="unstable", predicted=np.where(good.time < 20, good.predicted, np.inf))
    figure = comparison_plot([good, runaway]).figure
    texts = [text.get_text() for text in figure.legends[0].get_texts()]
    assert texts[2] == "unstable, free run: RMSE not finite (leaves the axis)"
    low, high = figure.axes[0].get_ylim()
    assert low > -200
    assert high < 450


def test_horizons_are_drawn_as_separate_pieces(responses):
    line = comparison_plot(responses[2:3]).figure.axes[0].get_lines()[1]
    assert np.isnan(line.get_ydata()).sum() == 24


def test_a_runaway_does_not_make_the_other_errors_unreadable(responses):
    wild = replace(responses[0], model="wild", predicted=responses[0].measured + 5e4)
    texts = [
        text.get_text() for text in comparison_plot([*responses[:2], wild]).figure.legends[0].get_texts()
    ]
    assert texts[1].endswith(f"RMSE {1e3 * responses[0].rmse:.3g} mm")
