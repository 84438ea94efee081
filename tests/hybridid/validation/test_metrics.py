"""The thesis' three numbers and the fit percentage, by hand."""

from __future__ import annotations

import numpy as np
import pytest

from hybridid.validation import Prediction, metrics


def prediction(measured, predicted) -> Prediction:
    measured, predicted = np.atleast_2d(measured).T, np.atleast_2d(predicted).T
    n, n_y = measured.shape
    return Prediction(
        record="by_hand",
        view="free_run",
        provenance="simulated",
        time=np.arange(n) * 0.1,
        measured=measured,
        predicted=predicted,
        states=np.zeros((n, 1)),
        output_names=tuple(f"y{k}" for k in range(n_y)),
        output_units=("m",) * n_y,
        state_names=("x",),
        breaks=(0,),
        initial_states=np.zeros((1, 1)),
    )


def test_thesis_equations_3_15_to_3_17():
    (row,) = metrics(prediction([1.0, 2.0, 4.0, 5.0], [1.5, 2.0, 3.0, 5.5]), "gray")
    # errors -0.5, 0, 1, -0.5: squares 0.25 + 0 + 1 + 0.25 = 1.5; mean 3: spread 4 + 1 + 1 + 4 = 10
    assert row.mse == pytest.approx(0.375)
    assert row.rmse == pytest.approx(0.375**0.5)
    assert row.mae == pytest.approx(0.5)
    assert row.r2 == pytest.approx(0.85)
    assert row.fit_percent == pytest.approx(100 * (1 - 0.15**0.5))
    assert (row.model, row.record, row.output, row.view, row.n) == ("gray", "by_hand", "y0", "free_run", 4)
    assert (row.unit, row.provenance) == ("m", "simulated")


def test_each_output_has_its_row():
    rows = metrics(prediction([[1.0, 3.0], [10.0, 30.0]], [[1.0, 3.0], [10.0, 10.0]]), "gray")
    assert [row.output for row in rows] == ["y0", "y1"]
    assert (rows[0].mse, rows[0].r2) == (0.0, 1.0)
    assert (rows[1].mse, rows[1].r2) == (200.0, -1.0)


def test_predicting_the_mean_explains_nothing():
    (row,) = metrics(prediction([1.0, 2.0, 3.0], [2.0, 2.0, 2.0]), "mean")
    assert row.r2 == pytest.approx(0.0)
    assert row.fit_percent == pytest.approx(0.0)


def test_an_output_that_stands_still_has_no_share_to_explain():
    (wrong,) = metrics(prediction([2.0, 2.0], [2.0, 2.1]), "gray")
    (right,) = metrics(prediction([2.0, 2.0], [2.0, 2.0]), "gray")
    assert wrong.r2 == -np.inf
    assert right.r2 == 1.0
    assert right.fit_percent == 100.0
