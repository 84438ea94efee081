"""What a residual still holds is found, and what it does not hold is not."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import stats

from hybridid.records.record import Channel, Record
from hybridid.validation import Prediction, residual_tests

N, DT = 1500, 0.01


def examined(error: np.ndarray, u: np.ndarray, lags: int = 20):
    """Tests of ``error`` (N,) beside the input ``u`` (N,)."""
    n = len(error)
    time = np.arange(n) * DT
    outputs = np.sin(time)[:, None] + error[:, None]
    record = Record("made", time, u[:, None], outputs, (Channel("u", "V"),), (Channel("y", "m"),))
    prediction = Prediction(
        record="made",
        view="free_run",
        provenance="simulated",
        time=time,
        measured=outputs,
        predicted=np.sin(time)[:, None],
        states=np.zeros((n, 1)),
        output_names=("y",),
        output_units=("m",),
        state_names=("x",),
        breaks=(0,),
        initial_states=np.zeros((1, 1)),
    )
    (found,) = residual_tests(prediction, record, lags)
    return found


def test_white_residuals_have_uniform_p_values(noise):
    u = noise(N, 1.0, 0.95, seed=999)
    p = [examined(noise(N, 1e-3, seed=s), u).p_white for s in range(200)]
    assert stats.kstest(p, "uniform").pvalue > 0.01
    assert 0.01 < np.mean(np.array(p) < 0.05) < 0.1


def test_coloured_residuals_are_not_white(noise):
    u = noise(N, 1.0, seed=999)
    for rho, seed in ((0.2, 1), (-0.2, 2), (0.9, 3)):
        found = examined(noise(N, 1e-3, rho, seed=seed), u)
        assert found.p_white < 1e-6
        assert found.autocorrelation[1] == pytest.approx(rho, abs=0.08)
        assert abs(found.autocorrelation[1]) > found.band


def test_the_statistic_is_ljungs_and_boxs(noise):
    from statsmodels.stats.diagnostic import acorr_ljungbox

    error = noise(N, 1e-3, 0.05, seed=7)
    expected = acorr_ljungbox(error - error.mean(), lags=[20])["lb_pvalue"].iloc[0]
    assert examined(error, noise(N, 1.0, seed=8)).p_white == pytest.approx(expected, rel=1e-6)


def test_lags_are_seconds_and_correlations_begin_at_one(noise):
    found = examined(noise(N, 1e-3, seed=1), noise(N, 1.0, seed=2))
    np.testing.assert_allclose(found.lags, np.arange(21) * DT)
    np.testing.assert_allclose(found.input_lags, np.arange(-20, 21) * DT)
    assert found.autocorrelation[0] == pytest.approx(1.0)
    assert found.band == pytest.approx(2.576 / np.sqrt(N), rel=1e-3)
    assert (found.record, found.output, found.provenance) == ("made", "y", "simulated")


def test_an_input_that_was_not_used_up_shows_at_its_delay(noise):
    """The residual repeats the input of seven samples ago: a peak at +70 ms."""
    u = noise(N, 1.0, 0.5, seed=3)
    found = examined(1e-4 * np.roll(u, 7) + noise(N, 1e-4, seed=4), u)
    cross = found.cross_correlation["u"]
    assert found.input_lags[np.argmax(np.abs(cross))] == pytest.approx(7 * DT)
    assert np.abs(cross).max() > 5 * found.input_bands["u"]


@pytest.mark.parametrize("rho", [0.0, 0.9])
def test_independent_series_stay_inside_their_band(noise, rho):
    """99 % of the lags, also where both are slow and chance correlations are large."""
    outside = []
    for seed in range(40):
        found = examined(noise(N, 1e-3, rho, seed=2 * seed), noise(N, 1.0, rho, seed=2 * seed + 1001))
        outside.append(np.mean(np.abs(found.cross_correlation["u"]) > found.input_bands["u"]))
    assert np.mean(outside) < 0.03
    if rho:
        naive = 2.576 / np.sqrt(N)
        assert found.input_bands["u"] > 2 * naive


def test_a_short_record_gets_fewer_lags(noise):
    found = examined(noise(60, 1e-3, seed=1), noise(60, 1.0, seed=2), lags=50)
    assert len(found.lags) == 16


def test_a_perfect_prediction_is_no_accident():
    found = examined(np.zeros(N), np.sin(np.arange(N)))
    assert np.isfinite(found.autocorrelation).all()
    assert found.p_white == 1.0


def test_nothing_correlates_with_an_input_that_stands_still(noise):
    found = examined(noise(N, 1e-3, seed=7), np.full(N, 200.0))
    assert found.cross_correlation == {}
    assert found.input_bands == {}
