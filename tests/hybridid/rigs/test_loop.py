"""Encoder, drive and controller, one sample at a time."""

from __future__ import annotations

import numpy as np
import pytest

from hybridid.rigs.laws import RigError
from hybridid.rigs.loop import PD, CascadedPD, Drive, Encoder


def test_an_encoder_counts():
    encoder = Encoder(resolution=5e-8)
    readings = np.array([encoder.read(q) for q in np.linspace(-1e-6, 1e-6, 1001)])
    counts = readings / 5e-8
    assert np.abs(counts - np.round(counts)).max() < 1e-9
    assert np.abs(readings - np.linspace(-1e-6, 1e-6, 1001)).max() <= 2.5e-8 * (1 + 1e-9)


def test_encoder_noise_has_its_standard_deviation():
    noise = Encoder(5e-8, noise_std=2e-6).noise(20_000, np.random.default_rng(0))
    assert noise.std() == pytest.approx(2e-6, rel=0.02)
    assert not Encoder(5e-8).noise(10, np.random.default_rng(0)).any()


def test_the_drive_saturates_both_ways():
    drive = Drive(gain=35.15, saturation=10.0)
    assert [drive.voltage(command) for command in (-12.0, -3.0, 11.0)] == [-10.0, -3.0, 10.0]


def test_the_controller_is_the_cascade_with_the_velocity_of_the_filtered_position():
    kp, kv, dt = 160.18, 243.45, 1e-3
    q = np.array([0.0100, 0.0101, 0.0103])
    filtered = 0.5 * (q[1:] + q[:-1])
    velocity = (filtered[1] - filtered[0]) / dt
    expected = kp * kv * (0.02 - q[2]) - kv * velocity
    assert CascadedPD(kp, kv).command(0.02, (q[2], q[1], q[0]), dt) == pytest.approx(expected, rel=1e-9)


def test_a_pd_answers_the_error_and_its_slope():
    assert PD(kp=3.0, kd=0.05).command(0.2, 0.1, 2e-3) == pytest.approx(3.0 * 0.2 + 0.05 * 50.0)


@pytest.mark.parametrize(
    "make", [lambda: Encoder(0.0), lambda: Encoder(1e-8, -1.0), lambda: Drive(35.0, 0.0)]
)
def test_parts_that_cannot_be_are_refused(make):
    with pytest.raises(RigError, match="must"):
        make()
