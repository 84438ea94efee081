"""What the network is fed."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from hybridid.residuals.orders import Orders
from hybridid.residuals.regressors import Scaling, exogenous, lagged, on_grid, scaled_error

PLAIN = Scaling(error=1.0, input_mean=(0.0,), input_size=(1.0,), gray_mean=0.0, gray_size=1.0)


def test_lags_are_strictly_past():
    found = lagged(np.array([1.0, 2.0, 3.0]), 2, before=9.0)
    np.testing.assert_array_equal(found, [[9, 9], [1, 9], [2, 1]])


def test_order_zero_leaves_a_signal_out():
    assert lagged(np.arange(4.0), 0, 0.0).shape == (4, 0)


def test_an_input_is_averaged_up_to_the_next_grid_sample():
    u = np.arange(5.0)[:, None]
    np.testing.assert_array_equal(on_grid(u, 2)[:, 0], [0.5, 2.5, 4.0])
    np.testing.assert_array_equal(on_grid(u, 1), u)


def test_columns_are_inputs_then_gray(series):
    seen = series(50, 0).seen
    rows = exogenous(seen, slice(0, 50), Orders(0, (2,), 1), PLAIN, every=1)
    t = 20
    np.testing.assert_allclose(rows[t], [seen.inputs[t - 1, 0], seen.inputs[t - 2, 0], seen.gray[t - 1]])


def test_before_a_piece_signals_stood_still(series):
    seen = replace(series(50, 0).seen, breaks=(0, 30))
    rows = exogenous(seen, seen.pieces[1], Orders(0, (1,), 1), PLAIN, every=1)
    np.testing.assert_allclose(rows[0], [seen.inputs[30, 0], seen.gray[30]])


def test_scaling_is_of_order_one(series):
    one = series(3000, 1)
    scaling = Scaling.of([one], every=1)
    rows = exogenous(one.seen, slice(0, 3000), Orders(0, (1,), 1), scaling, every=1)
    np.testing.assert_allclose(rows.std(axis=0), 1.0, rtol=0.01)
    assert np.mean(scaled_error(one, slice(0, 3000), scaling, 1) ** 2) == pytest.approx(1.0)


def test_no_error_is_nothing_to_learn(series):
    perfect = replace(series(50, 0), error=np.zeros(50))
    with pytest.raises(ValueError, match="no error of y"):
        Scaling.of([perfect], 1)
