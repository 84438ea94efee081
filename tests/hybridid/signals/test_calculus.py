"""Integrals without drift, derivatives without their noise, both against known functions."""

from __future__ import annotations

import numpy as np
import pytest

from hybridid.records.record import RecordError
from hybridid.signals.calculus import Differentiate, Integrate, SavitzkyGolay
from hybridid.signals.step import StepError

W = 2 * np.pi * 1.5  # rad/s


def velocity(t: np.ndarray) -> np.ndarray:
    """A body's vertical velocity, m/s: zero mean over the whole seconds of the record."""
    return 0.3 * np.sin(W * t) + 0.1 * np.cos(4 * W * t)


def acceleration(t: np.ndarray) -> np.ndarray:
    return W * (0.3 * np.cos(W * t) - 0.4 * np.sin(4 * W * t))


def test_the_integral_of_a_known_function(record_of):
    record = record_of(y=acceleration, n=20001)
    made = Integrate("position", "velocity", "m/s", initial=velocity(0.0)).apply(record)
    np.testing.assert_allclose(made.output("velocity"), velocity(record.time), atol=1e-4)
    assert [(c.name, c.unit) for c in made.output_channels] == [("position", "m"), ("velocity", "m/s")]
    assert np.array_equal(made.output("position"), record.output("position"))


@pytest.mark.parametrize("offset", [-0.5, 0.02, 3.0])
@pytest.mark.parametrize(
    ("drift", "within"),
    [({"drift": "mean"}, 0.11), ({"drift": "linear"}, 0.02), ({"drift": "highpass", "cutoff": 0.15}, 0.02)],
)
def test_a_sensor_offset_does_not_make_the_velocity_drift(record_of, offset, drift, within):
    """20 s of acceleration whose sensor is off by a constant, and the velocity at the start unknown."""
    record = record_of(y=lambda t: acceleration(t) + offset, n=20001)
    settled = slice(5000, 15000)

    def error(**options) -> float:
        made = Integrate("position", "velocity", "m/s", **options).apply(record)
        return float(np.abs(made.output("velocity") - velocity(record.time))[settled].max())

    assert error(**drift) < within
    assert error() > abs(offset) * 8


def test_a_wandering_offset_needs_a_high_pass(record_of):
    record = record_of(y=lambda t: acceleration(t) + 0.5 * np.sin(2 * np.pi * 0.03 * t), n=40001)
    settled = slice(10000, 30000)

    def error(**options) -> float:
        made = Integrate("position", "velocity", "m/s", **options).apply(record)
        return float(np.abs(made.output("velocity") - velocity(record.time))[settled].max())

    assert error(drift="highpass", cutoff=0.4, order=3) < 0.02
    assert error(drift="linear") > 0.3


def test_where_the_new_signal_goes(record_of):
    record = record_of()
    aside = Integrate("force", "impulse", "N·s", role="auxiliary").apply(record)
    assert [c.name for c in aside.auxiliary_channels] == ["reference", "impulse"]
    instead = Integrate("position", "absement", "m·s", demote=True).apply(record)
    assert [c.name for c in instead.output_channels] == ["absement"]
    assert [c.name for c in instead.auxiliary_channels] == ["reference", "position"]
    assert np.array_equal(instead.signal("position"), record.output("position"))
    driving = Differentiate("position", "speed", "m/s", cutoff=50.0, role="input").apply(record)
    assert [(c.name, c.hold) for c in driving.input_channels][-1] == ("speed", "foh")
    assert driving.output_channels == record.output_channels
    over = Integrate("position", "position", "m·s").apply(record)
    assert [(c.name, c.unit) for c in over.output_channels] == [("position", "m·s")]
    with pytest.raises(StepError, match="already has a signal 'reference'"):
        Integrate("position", "reference", "m·s").apply(record)
    with pytest.raises(RecordError, match="unknown signal 'positon': did you mean 'position'"):
        Integrate("positon", "x", "m·s").apply(record)


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ({"drift": "highpass"}, "highpass needs a cutoff"),
        ({"drift": "mean", "cutoff": 1.0}, "others have none"),
        ({"drift": "highpass", "cutoff": -1.0}, "cutoff is -1 Hz"),
        ({"drift": "linear", "initial": 1.0}, "drift: linear takes out any initial value"),
        ({"drift": "highpass", "cutoff": 600.0}, "below 500 Hz"),
    ],
)
def test_impossible_integrals(record_of, options, said):
    with pytest.raises(StepError, match=said):
        Integrate("position", "v", "m/s", **options).apply(record_of())


@pytest.mark.parametrize("derivative", [1, 2])
def test_a_derivative_through_noise(record_of, derivative):
    noise = np.random.default_rng(0).normal(size=20000) * 1e-5

    def position(t: np.ndarray) -> np.ndarray:
        return 0.1 * np.sin(W * t)

    exact = {1: lambda t: 0.1 * W * np.cos(W * t), 2: lambda t: -0.1 * W**2 * np.sin(W * t)}[derivative]
    record = record_of(y=lambda t: position(t) + noise, n=20000)
    step = Differentiate("position", "rate", "m/s", cutoff=20.0, derivative=derivative)
    error = (step.apply(record).output("rate") - exact(record.time))[500:-500]
    assert np.sqrt(np.mean(error**2)) < 1e-3 * np.ptp(exact(record.time))
    raw = np.gradient(record.output("position"), 1e-3)
    if derivative == 1:
        assert np.std(error) < np.std(raw[500:-500] - exact(record.time)[500:-500]) / 10


def test_integral_and_derivative_undo_each_other(record_of):
    record = record_of(y=velocity, n=20000)
    there = Integrate("position", "x", "m").apply(record)
    back = Differentiate("x", "v", "m/s", cutoff=100.0).apply(there)
    np.testing.assert_allclose(back.output("v")[200:-200], velocity(record.time)[200:-200], atol=1e-4)


@pytest.mark.parametrize("derivative", [0, 1, 2])
def test_savitzky_golay_is_exact_for_its_polynomials(record_of, derivative):
    polynomial = np.polynomial.Polynomial([0.2, -1.0, 3.0, 0.7])
    record = record_of(y=polynomial)
    step = SavitzkyGolay("position", 21, 3, derivative, name="d", unit="m/s")
    exact = polynomial.deriv(derivative)(record.time) if derivative else polynomial(record.time)
    np.testing.assert_allclose(step.apply(record).output("d"), exact, atol=1e-6)


def test_savitzky_golay_smooths_in_place(record_of):
    noise = np.random.default_rng(1).normal(size=2000)
    smooth = SavitzkyGolay("position", 51).apply(record_of(y=lambda t: noise))
    assert [(c.name, c.unit) for c in smooth.output_channels] == [("position", "m")]
    assert np.std(smooth.output("position")) < 0.4


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ({"window": 20}, "an odd window"),
        ({"window": 3}, "polynomial < window"),
        ({"window": 21, "derivative": 4}, "derivative <= polynomial"),
        ({"window": 21, "derivative": 1}, "give unit"),
        ({"window": 2001}, "window is 2001, record bench has only 2000 samples"),
    ],
)
def test_impossible_windows(record_of, options, said):
    with pytest.raises(StepError, match=said):
        SavitzkyGolay("position", **options).apply(record_of())
