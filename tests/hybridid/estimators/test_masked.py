"""Masked samples of the simulated carriage: what they say has no say, and what they cut apart starts anew."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from hybridid.estimators import FitSettings, fit
from hybridid.model import compose
from hybridid.plotting.trace_missing_effort import missing_effort_plot
from hybridid.records.record import Channel, RecordError
from hybridid.records.sensor_noise import noise_level
from hybridid.residuals.series import error_series
from hybridid.signals.masks import Mask
from hybridid.simulation.stability import substeps_wanted
from hybridid.simulation.windows import cut
from hybridid.trace.horizons.split import by_blocks
from hybridid.trace.ports.missing_effort import missing_effort
from hybridid.validation import free_run, horizon_run, metrics, residual_tests

DEAD = ((0.8, 1.1), (1.9, 2.0))
"""Stretches in s where the simulated encoder drops out."""


@pytest.fixture(scope="module")
def dropped(noisy):
    """The noisy carriage whose encoder shows ``value`` m where it is dead."""

    def make(value):
        outputs = noisy.outputs.copy()
        for start, stop in DEAD:
            outputs[(noisy.time >= start) & (noisy.time < stop)] = value
        return replace(noisy, outputs=outputs, warnings=())

    return make


@pytest.mark.parametrize("horizon", [None, 50])
def test_a_dead_sensor_that_is_masked_moves_no_parameter(symmetric, dropped, carriage, of_noise, horizon):
    settings = FitSettings(horizon=horizon)
    masked, other = (
        fit(symmetric, [Mask(stretches=DEAD).apply(dropped(value))], settings) for value in (0.0, 0.3)
    )
    np.testing.assert_allclose([*masked.values.values()], [*other.values.values()], rtol=1e-9)
    away = np.array([masked.values[name] - value for name, value in carriage.truth.items()])
    assert np.abs(away / of_noise(masked)).max() < 3
    spoiled = fit(symmetric, [dropped(0.0)], settings)
    far = np.array([spoiled.values[name] - value for name, value in carriage.truth.items()])
    assert np.abs(far).max() > 20 * np.abs(away).max()


@pytest.mark.parametrize("through", [True, False])
def test_a_masked_end_is_as_good_as_cut_off(symmetric, noisy, values_of, of_noise, through):
    masked = fit(symmetric, [Mask(stretches=((2.0, 9.0),), through=through).apply(noisy)])
    cropped = fit(symmetric, [noisy.part(0, 400)])
    np.testing.assert_allclose(values_of(masked), values_of(cropped), rtol=1e-6)
    np.testing.assert_allclose(of_noise(masked), of_noise(cropped), rtol=1e-3)


def test_a_hole_costs_as_much_certainty_as_its_samples_are_worth(symmetric, carriage, noise, of_noise):
    """Under noise that runs on through the hole: what is left is as certain as the noise's model says."""
    record = carriage.record(noise=noise(600, 1e-5, 0.9, seed=4))
    whole = fit(symmetric, [record])
    holes = tuple((0.3 + 0.6 * k, 0.45 + 0.6 * k) for k in range(5))
    masked = fit(symmetric, [Mask(stretches=holes).apply(record)])
    ratio = of_noise(masked) / of_noise(whole)
    assert (ratio > 0.9).all()
    assert (ratio < 1.6).all()


def test_by_hand_through_a_gap(symmetric, carriage, noise):
    """Between two runs somebody moves the carriage: the simulation ends there and starts anew."""
    first, second = (carriage.record(n=500, noise=noise(500, 1e-5, seed=s)) for s in (1, 2))
    hand = 0.4 * np.sin(np.linspace(0, 3, 200))
    outputs = np.concatenate([first.outputs[:, 0], hand, second.outputs[:, 0] + hand[-1]])
    inputs = np.concatenate([first.inputs, np.zeros((200, 1)), second.inputs])
    time = np.arange(1200) * first.dt
    record = replace(first, time=time, inputs=inputs, outputs=outputs[:, None], warnings=())
    masked = Mask(stretches=((2.5, 3.5),), through=False).apply(record)
    estimate = fit(symmetric, [masked])
    assert estimate.values["M"] == pytest.approx(carriage.M, rel=0.01)
    run = free_run(symmetric, estimate.values, masked)
    assert run.breaks == (0, 700)
    np.testing.assert_array_equal(run.rows, np.r_[0:500, 700:1200])
    np.testing.assert_array_equal(run.holes, [[time[499], time[700]]])
    assert np.sqrt(np.mean(run.error**2)) < 2e-5
    through = free_run(symmetric, estimate.values, Mask(stretches=((2.5, 3.5),)).apply(record))
    assert through.breaks == (0,)
    assert np.sqrt(np.mean(through.error**2)) > 1e-2, "the inputs do not tell of the hand"


def test_horizons_begin_and_end_at_samples_that_count(noisy):
    masked = Mask(stretches=((0.45, 0.55), (1.0, 1.7))).apply(noisy)
    windows = cut([masked], 100, 1)
    assert windows.origin == ((0, 0, 110), (0, 110, 200), (0, 340, 440), (0, 440, 540), (0, 540, 600))
    assert windows.heads == {(0, 0), (0, 340)}, "a mask longer than a horizon is not gone through"
    assert windows.complete
    assert windows.samples == masked.counts.sum()
    assert all(row[0] for row in windows.used)
    apart = cut([Mask(stretches=((0.45, 0.55),), through=False).apply(noisy)], 100, 1)
    assert apart.origin[:2] == ((0, 0, 90), (0, 110, 210))
    assert apart.heads == {(0, 0), (0, 110)}


def test_a_mask_that_leaves_no_horizon_is_told(noisy):
    scattered = tuple((0.025 * k, 0.025 * k + 0.02) for k in range(100))
    masked = Mask(stretches=scattered, through=False).apply(noisy.part(0, 500))
    with pytest.raises(ValueError, match="the mask leaves no horizon of carriage"):
        cut([masked], None, 1)


def test_both_methods_leave_it_out(symmetric, dropped, values_of):
    masked = Mask(stretches=DEAD).apply(dropped(0.1))
    fast, slow = (
        fit(symmetric, [masked], FitSettings(method=m)) for m in ("gauss_newton", "multiple_shooting")
    )
    np.testing.assert_allclose(values_of(fast), values_of(slow), rtol=1e-4)


def test_scores_and_tests_count_only_what_counts(symmetric, dropped, noisy, carriage):
    masked = Mask(stretches=DEAD).apply(dropped(5.0))
    run = free_run(symmetric, carriage.truth, masked)
    row = metrics(run, "gray box")[0]
    assert row.n == masked.counts.sum() == 600 - 80
    assert row.rmse < 2e-5
    (found,), (whole,) = (
        residual_tests(run, masked, 50),
        residual_tests(free_run(symmetric, carriage.truth, noisy), noisy, 50),
    )
    assert found.p_white > 0.01
    assert found.band == pytest.approx(whole.band * np.sqrt(600 / 520))
    force = found.cross_correlation["force"]
    assert np.mean(np.abs(force) < found.input_bands["force"]) > 0.9
    horizons = horizon_run(symmetric, carriage.truth, masked, 100)
    assert len(horizons.starts) == len(horizons.breaks)
    np.testing.assert_array_equal(horizons.time[horizons.starts], masked.time[list(horizons.breaks)])


def test_the_noise_is_that_of_what_counts(dropped, noisy):
    masked = Mask(stretches=DEAD).apply(dropped(5.0))
    np.testing.assert_allclose(noise_level(masked), noise_level(noisy), rtol=0.15)


def test_a_trace_judges_on_horizons_of_what_counts(dropped):
    masked = Mask(stretches=DEAD).apply(dropped(5.0))
    split = by_blocks([masked], 60)
    windows = cut(split.records, 60, 1)
    assert windows.outputs[windows.used].max() < 1.0
    assert len(split.fitted) + len(split.held_out) == windows.count


def test_a_missing_effort_bridges_what_does_not_count(make_model, carriage_like, noise):
    """A drag that the model lacks is found as before where a dead encoder is masked."""
    record = carriage_like(drag=60.0).record(noise=noise(600, 1e-5, seed=3))
    dead = np.where((record.time >= 1.2) & (record.time < 1.3), 0.0, record.outputs[:, 0])
    masked = Mask(stretches=((1.2, 1.3),)).apply(replace(record, outputs=dead[:, None], warnings=()))
    model, truth = make_model(), carriage_like().truth
    clean, found = (missing_effort(model, truth, one, "carriage") for one in (record, masked))
    np.testing.assert_array_equal(found.rows, np.flatnonzero(masked.counts))
    np.testing.assert_allclose(found.effort, clean.effort[masked.counts], atol=5.0)
    np.testing.assert_array_equal(found.of(record.input("force")), record.input("force")[masked.counts])
    np.testing.assert_allclose(found.holes, [[1.195, 1.3]])
    apart = Mask(stretches=((1.2, 1.3),), through=False).apply(record)
    later = missing_effort(model, truth, apart, "carriage")
    assert later.time[0] == pytest.approx(1.3)
    np.testing.assert_array_equal(later.rows, np.arange(260, 600))
    plot = missing_effort_plot({"gray box": found}, {"force": (record.input("force"), "N")})
    assert plot.caption.endswith("shaded: masked, does not count.")


def test_a_network_on_the_output_error_refuses_a_masked_record(symmetric, noisy, carriage):
    masked = Mask(stretches=DEAD).apply(noisy)
    run = free_run(symmetric, carriage.truth, masked)
    with pytest.raises(
        RecordError, match=r"record carriage is masked, first from .*: residual=narx runs through whole"
    ):
        error_series(run, masked, "position")


def test_steps_are_as_long_as_what_counts_allows(noisy):
    """A dead sensor that shows 1 kV, far up a spring that stiffens, asks for no short steps if masked."""
    from hybridid.plants.duffing import Duffing

    model = compose(Duffing(), ["cubic_stiffness"])
    channels = {
        "input_channels": tuple(Channel(s.name, s.unit) for s in model.inputs),
        "output_channels": tuple(Channel(s.name, s.unit) for s in model.outputs),
    }
    dead = noisy.outputs.copy()
    dead[200:260] = 1e3
    record = replace(noisy, outputs=dead, warnings=(), **channels)
    masked = Mask(stretches=((1.0, 1.3),)).apply(record)
    p = model.values()
    clean = substeps_wanted(model, p, [replace(noisy, warnings=(), **channels)])
    assert substeps_wanted(model, p, [masked]) == clean < substeps_wanted(model, p, [record])
