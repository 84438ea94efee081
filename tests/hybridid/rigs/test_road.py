"""The bump, the driver and the inertial sensor."""

from __future__ import annotations

import numpy as np
import pytest

from hybridid.rigs.laws import RigError
from hybridid.rigs.road import Bump, Driver, Sensor


def test_a_bump_is_level_before_and_after_and_smooth_at_its_feet():
    x = np.linspace(-1, 3, 4001)
    u = Bump(height=0.1, length=2.0)(x)
    assert not u[(x <= 0) | (x >= 2)].any()
    assert u.max() == pytest.approx(0.1)
    assert u == pytest.approx(u[::-1], abs=1e-12)
    assert np.abs(np.diff(u) / 1e-3).max() == pytest.approx(0.1 * np.pi / 2, rel=1e-3)


def test_a_driver_who_neither_wanders_nor_sags_holds_the_speed():
    speed = Driver().speed(5.0, np.linspace(-1, 1, 50), 0.04, np.random.default_rng(0))
    assert np.array_equal(speed, np.full(50, 5.0))


def test_the_bump_costs_its_share_of_the_speed_which_comes_back():
    since = np.linspace(-1, 5, 6001)
    speed = Driver(sag=0.1, recovery=0.5).speed(5.0, since, 1e-3, np.random.default_rng(0))
    assert (speed[since <= 0] == 5.0).all()
    assert speed.min() == pytest.approx(4.5)
    assert since[speed.argmin()] == pytest.approx(0.5, abs=2e-3)
    assert speed[-1] == pytest.approx(5.0, rel=1e-3)


def test_the_wander_is_stationary_with_its_deviation_and_memory():
    driver = Driver(wander=0.02, memory=0.5)
    runs = [driver.speed(1.0, np.zeros(201), 0.01, np.random.default_rng(seed)) - 1 for seed in range(1500)]
    w = np.array(runs)
    assert w[:, [0, 100, 200]].std(axis=0) == pytest.approx(np.full(3, 0.02), rel=0.06)
    assert np.corrcoef(w[:, 50], w[:, 100])[0, 1] == pytest.approx(np.exp(-1), abs=0.06)


def test_a_sensor_adds_its_bias_noise_and_the_engine():
    t = np.arange(20000) * 0.01
    read = Sensor(noise=0.1, bias=0.5, vibration=0.3, frequency=7.0).read(
        np.sin(t), t, np.random.default_rng(1)
    )
    error = read - np.sin(t)
    engine = 2 * np.abs(np.mean(error * np.exp(-2j * np.pi * 7.0 * t)))
    assert error.mean() == pytest.approx(0.5, abs=5e-3)
    assert engine == pytest.approx(0.3, abs=5e-3)
    assert error.var() == pytest.approx(0.1**2 + 0.3**2 / 2, rel=0.03)


@pytest.mark.parametrize(
    ("make", "said"),
    [
        (lambda: Bump(height=-0.1, length=1.0), "height must not be below 0"),
        (lambda: Bump(height=0.1, length=0.0), "length must be above 0"),
        (lambda: Driver(wander=-0.1), "wander and sag must be 0 or more"),
        (lambda: Driver(memory=0.0), "memory and recovery above 0"),
        (lambda: Sensor(noise=-1.0), "noise must not be below 0"),
    ],
)
def test_what_cannot_be_is_refused(make, said):
    with pytest.raises(RigError, match=said):
        make()
