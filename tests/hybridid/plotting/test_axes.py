"""Scales and limits."""

from __future__ import annotations

import numpy as np
import pytest

from hybridid.plotting.axes import (
    frame,
    frame_data,
    leaves,
    scale_for,
    time_scale,
)


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
