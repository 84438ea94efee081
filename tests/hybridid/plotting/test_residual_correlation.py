"""Residual correlations: white stays in the band, coloured does not, and both are said."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from hybridid.plotting.residual_correlation import residual_correlation_plot
from hybridid.validation import residual_tests


def residual_of(record, predict, error, lags=40):
    prediction = predict(record)
    return residual_tests(replace(prediction, predicted=prediction.measured - error[:, None]), record, lags)[
        0
    ]


def outside(axes):
    return float(axes.get_title(loc="left").split(": ")[1].split(" %")[0])


def test_white_residuals_stay_in_the_band_and_coloured_ones_leave_it(record, predict):
    noise = np.random.default_rng(0).standard_normal(record.n)
    white = residual_correlation_plot("model", residual_of(record, predict, noise))
    coloured = residual_correlation_plot("model", residual_of(record, predict, np.cumsum(noise)))
    assert outside(white.figure.axes[0]) <= 5
    assert outside(coloured.figure.axes[0]) == 100
    assert "Ljung-Box test of whiteness: p = 0." in white.caption
    assert "p < 10⁻¹⁵" in coloured.caption


def test_the_band_is_drawn_as_tested(record, predict):
    tests = residual_of(record, predict, np.random.default_rng(0).standard_normal(record.n))
    auto, cross = residual_correlation_plot("model", tests).figure.axes
    for axes, band in ((auto, tests.band), (cross, tests.input_bands["force"])):
        (patch,) = [p for p in axes.patches if p.get_gid() == "band"]
        assert patch.get_y() == pytest.approx(-band)
        assert patch.get_height() == pytest.approx(2 * band)
    assert auto.get_xlabel() == cross.get_xlabel() == "lag [ms]"
    assert cross.get_title(loc="left").startswith("cross-correlation with force: ")


def test_many_lags_are_a_line_and_few_are_stems(record, predict):
    noise = np.random.default_rng(0).standard_normal(record.n)
    few = residual_correlation_plot("model", residual_of(record, predict, noise, 20)).figure.axes[0]
    many = residual_correlation_plot("model", residual_of(record, predict, noise, 500)).figure.axes[0]
    assert len(few.collections) == 1
    assert len(many.collections) == 0
    assert len(many.get_lines()[1].get_xdata()) == 501


def test_every_input_has_its_panel(record, predict):
    tests = residual_of(record, predict, np.random.default_rng(0).standard_normal(record.n))
    values, band = tests.cross_correlation["force"], tests.input_bands["force"]
    two = replace(
        tests,
        cross_correlation={"force": values, "load_torque": values},
        input_bands={"force": band, "load_torque": band},
    )
    titles = [a.get_title(loc="left") for a in residual_correlation_plot("model", two).figure.axes]
    assert len(titles) == 3
    assert titles[2].startswith("cross-correlation with load torque")
