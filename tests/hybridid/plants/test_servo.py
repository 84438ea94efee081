"""The servo: its firmware's law and its motor against plain arithmetic, and a fit to the measured one."""

from __future__ import annotations

from math import pi, sin

import numpy as np
import pytest

from hybridid.model import compose
from hybridid.plants.servo import ROUNDING, Servo

E = 4096 / (2 * pi * 256 * 885)
M, L, J, K_T, R, G = 0.49, 0.1, 0.002, 0.3, 3.4, 9.80665


def acceleration(q: float, v: float, goal: float, kp: float, enabled: float = 1.0, **values: float) -> float:
    model = compose(Servo())
    given = {"J": J, "k_t": K_T, "R_s": 0.0, "q_0": 0.0, **values}
    return float(np.asarray(model.f(0, [q, v], [goal, kp, 7.4, enabled], model.values(given)))[1, 0])


def by_hand(q: float, v: float, duty: float, resistance: float = R) -> float:
    motor = K_T * (7.4 * duty - K_T * v) / resistance
    return (motor - M * G * L * sin(q)) / (J + M * L**2)


def test_the_torque_follows_the_firmwares_law():
    duty = 400 * E * (0.5 - 0.2)
    assert acceleration(0.2, 1.5, goal=0.5, kp=400) == pytest.approx(by_hand(0.2, 1.5, duty), rel=1e-3)


def test_the_firmware_sees_its_own_encoder():
    duty = 400 * E * (0.5 - 0.25)
    assert acceleration(0.2, 0.0, goal=0.5, kp=400, q_0=0.05) == pytest.approx(
        by_hand(0.2, 0, duty), rel=1e-3
    )


@pytest.mark.parametrize("asked", [-3.0, -1.0, -0.99, -0.5, 0.0, 0.3, 0.999, 1.0, 1.001, 2.0, 40.0])
def test_the_duty_is_clipped_within_a_thousandth(asked):
    """From the acceleration at rest, hanging down, where nothing but the duty acts."""
    found = acceleration(0.0, 0.0, goal=asked / (800 * E), kp=800) / by_hand(0.0, 0.0, 1.0)
    assert found == pytest.approx(np.clip(asked, -1, 1), abs=1e-3)
    assert ROUNDING <= 1e-3


def test_without_torque_neither_motor_nor_back_emf_acts():
    assert acceleration(0.7, 9.0, goal=-1.0, kp=800, enabled=0.0) == pytest.approx(
        -M * G * L * sin(0.7) / (J + M * L**2)
    )


def test_the_resistance_before_the_bridge_counts_with_the_square_of_the_duty():
    duty = 400 * E * (0.5 - 0.2)
    expected = by_hand(0.2, 1.5, duty, resistance=R - 1.2 * (1 - duty**2))
    assert acceleration(0.2, 1.5, goal=0.5, kp=400, R_s=1.2) == pytest.approx(expected, rel=1e-3)
    stalled = acceleration(0.0, 0.0, goal=3.0, kp=800, R_s=1.2)
    assert stalled == pytest.approx(by_hand(0.0, 0.0, 1.0), rel=1e-2), "at full duty R_s is part of R"


def test_the_gear_carries_the_motors_torque_and_the_weight():
    """Load friction takes its share of |drive - load|: where the motor holds the weight, of both."""
    model = compose(Servo(), ["load_friction"])
    values = model.values({"J": J, "k_t": K_T, "R_s": 0.0, "joint.load_friction.mu": 0.1})
    q, v, duty = 0.6, 0.5, 400 * E * 0.4
    drive, load = K_T * (7.4 * duty - K_T * v) / R, -M * G * L * sin(q)
    expected = (drive + load - 0.1 * abs(drive - load)) / (J + M * L**2)
    found = float(np.asarray(model.f(0, [q, v], [q + 0.4, 400, 7.4, 1], values))[1, 0])
    assert found == pytest.approx(expected, rel=1e-3)
