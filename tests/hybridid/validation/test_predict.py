"""Two views of one model: over the whole record, and over horizons from initial states of their own."""

from __future__ import annotations

import numpy as np
import pytest

from hybridid.estimators import FitSettings, fit
from hybridid.simulation import Diverged, simulate
from hybridid.validation import free_run, horizon_run, metrics


@pytest.fixture(scope="module")
def model(make_model):
    return make_model()


@pytest.fixture(scope="module")
def made(carriage, noise):
    return carriage.record(noise=noise(600, 1e-5, seed=4))


def rmse(prediction) -> float:
    return metrics(prediction, "gray")[0].rmse


def test_the_true_model_leaves_the_noise(carriage, model, made):
    for view in (free_run(model, carriage.truth, made), horizon_run(model, carriage.truth, made, 100)):
        assert 0.9e-5 < rmse(view) < 1.1e-5


def test_one_horizon_as_long_as_the_record_is_the_free_run(carriage, model, made):
    whole, one = free_run(model, carriage.truth, made), horizon_run(model, carriage.truth, made, 600)
    np.testing.assert_allclose(whole.predicted, one.predicted, rtol=1e-9, atol=1e-13)
    assert (whole.view, one.view) == ("free_run", "horizon")
    assert whole.breaks == one.breaks == (0,)


def test_a_free_run_is_a_simulation_from_its_initial_state(carriage, model, made):
    view = free_run(model, carriage.truth, made)
    run = simulate(model, carriage.truth, made, view.initial_states[0])
    np.testing.assert_allclose(view.predicted, run.outputs, rtol=1e-12, atol=1e-15)
    np.testing.assert_allclose(view.states, run.states, rtol=1e-12, atol=1e-15)
    np.testing.assert_array_equal(view.measured, made.outputs)
    np.testing.assert_array_equal(view.error, made.outputs - view.predicted)
    assert (view.record, view.provenance) == ("carriage", "simulated")
    assert (view.output_names, view.output_units, view.state_names) == (("position",), ("m",), ("q", "v"))


def test_horizons_begin_where_they_are_said_to(carriage, model, made):
    view = horizon_run(model, carriage.truth, made, 250)
    assert view.breaks == (0, 250, 500)
    assert len(view.time) == 600
    np.testing.assert_allclose(view.states[list(view.breaks)], view.initial_states)


def test_initial_states_are_the_best_at_these_parameters(carriage, model, made):
    """The sum of squares over a horizon is flat at its initial state, also with wrong parameters."""
    wrong = carriage.truth | {"M": 105.0, "carriage.coulomb.f_c": 17.0}
    view = horizon_run(model, wrong, made, 200)
    start, stop = view.breaks[1], view.breaks[2]
    piece = made.part(start, stop)

    def squares(x0):
        return float(np.sum((simulate(model, wrong, piece, x0, 2).outputs - piece.outputs) ** 2))

    best = view.initial_states[1]
    for step in ([1e-5, 0], [-1e-5, 0], [0, 1e-4], [0, -1e-4]):
        assert squares(best + step) > squares(best)


def test_parameters_stay_as_they_are_given(carriage, model, made):
    fitted = fit(model, [made], FitSettings(horizon=150))
    off = dict(fitted.values, M=fitted.values["M"] * 1.2)
    assert rmse(horizon_run(model, off, made, 150)) > 5 * rmse(horizon_run(model, fitted.values, made, 150))


def test_a_measured_initial_state_is_what_the_first_samples_say(carriage, model, made):
    view = free_run(model, carriage.truth, made, initial_state="measured")
    assert view.initial_states[0, 0] == pytest.approx(made.outputs[:5, 0].mean(), abs=1e-3)
    assert rmse(view) > rmse(free_run(model, carriage.truth, made))


def test_an_unknown_initial_state_is_refused(carriage, model, made):
    with pytest.raises(ValueError, match="'guessed', allowed: estimated, measured"):
        free_run(model, carriage.truth, made, initial_state="guessed")


def test_free_runs_drift_where_horizons_do_not(carriage, model, made):
    """The carriage integrates: a friction 3 % off shows mostly in the long run."""
    off = carriage.truth | {"carriage.coulomb.f_c": 1.03 * 20.4, "carriage.offset.offset": -3.0}
    assert rmse(free_run(model, off, made)) > 4 * rmse(horizon_run(model, off, made, 100))


def test_a_model_that_leaves_the_numbers_says_when(make_model, made):
    model = make_model(("viscous", "cubic_stiffness"))
    wild = {"carriage.cubic_stiffness.k_3": -1e12, "carriage.viscous.f_v": 0.0, "M": 1.0}
    with pytest.raises((Diverged, ValueError)) as caught:
        free_run(model, wild, made)
    assert "\n" not in str(caught.value)


def test_a_run_that_leaves_the_record_diverges_though_it_is_still_a_number(carriage, model, made):
    """A machine that drives itself: exp(30 1/s · 3 s) is a number, and no prediction."""
    wild = {**carriage.truth, "carriage.viscous.f_v": -30.0 * carriage.truth["M"]}
    assert np.isfinite(simulate(model, wild, made).outputs).all()
    with pytest.raises(Diverged, match=r"record carriage diverged at t = [12]\.\d"):
        free_run(model, wild, made)
