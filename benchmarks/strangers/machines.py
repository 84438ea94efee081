"""The machines that the templates describe, simulated: nothing is missing in them, but for the slide.

Each is sampled at 500 Hz, the slow ones more slowly, with the noise of a good sensor. Units, names and
separators differ from one to the next. The equations are written out here, so hybridid is held against them.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np

from benchmarks.strangers.recording import Simulated, clock, noisy, push, run, sign, table
from benchmarks.strangers.tanks import heater, room, tank, two_tanks

SHORT = 5.0  # s, of the recordings that the tests fit


def carriage(seconds: float = SHORT) -> Simulated:
    t = clock(seconds)
    force = lambda s: push(s, 10.0)  # noqa: E731
    q, _ = run(lambda s, x: [x[1], (force(s) - 3.0 * x[1] - 1.5 * sign(x[1], 0.9)) / 2.0], [0.0, 0.0], t)
    text = table("t_ms,motor current [A],Position (mm)", t * 1000, force(t) / 2.5, noisy(q) * 1000)
    truth = {"M": 2.0, "guide.viscous.f_v": 3.0, "guide.coulomb.f_c": 1.5}
    return Simulated(text, truth, ("--scale", "force=2.5", "--hold", "force=foh"))


def rotary(seconds: float = SHORT) -> Simulated:
    t = clock(seconds)
    torque = lambda s: push(s, 0.5)  # noqa: E731
    q, _ = run(lambda s, x: [x[1], (torque(s) - 0.05 * x[1] - 0.06 * sign(x[1], 3.0)) / 0.02], [0.0, 0.0], t)
    text = table(
        "Zeit;Drehmoment_mNm;Winkel [°]",
        t,
        torque(t) * 1000,
        np.degrees(noisy(q)),
        separator=";",
        decimal=",",
    )
    truth = {"J": 0.02, "joint.viscous.f_v": 0.05, "joint.coulomb.f_c": 0.06}
    return Simulated(text, truth, ("--hold", "torque=foh"))


def driven_pendulum(seconds: float = SHORT) -> Simulated:
    t = clock(seconds)
    torque = lambda s: push(s, 0.6)  # noqa: E731

    def rates(s: float, x: np.ndarray) -> list[float]:
        resists = 0.05 * x[1] + 0.06 * sign(x[1], 3.0)
        return [x[1], (torque(s) - 0.8 * np.sin(x[0] - 0.05) - resists) / 0.02]

    q, _ = run(rates, [0.05, 0.0], t)
    text = table("time [s],torque [Nm],angle [deg]", t, torque(t), np.degrees(noisy(q)))
    truth = {"J": 0.02, "G": 0.8, "q_0": 0.05, "joint.viscous.f_v": 0.05, "joint.coulomb.f_c": 0.06}
    return Simulated(text, truth, ("--hold", "torque=foh"))


def pendulum(seconds: float = SHORT) -> Simulated:
    t = clock(seconds)
    q, _ = run(lambda s, x: [x[1], -20.0 * np.sin(x[0] - 0.02) - 0.1 * x[1]], [0.8, 0.0], t)
    return Simulated(
        table("time,angle_deg", t, np.degrees(noisy(q))), {"G": 20.0, "q_0": 0.02, "pivot.viscous.f_v": 0.1}
    )


def oscillator(seconds: float = SHORT) -> Simulated:
    t = clock(seconds)
    force = lambda s: push(s, 20.0)  # noqa: E731
    q, _ = run(lambda s, x: [x[1], (force(s) - 800.0 * x[0] - 6.0 * x[1]) / 4.0], [0.0, 0.0], t)
    text = table("F [kN],x [µm]", force(t) / 1000, noisy(q) * 1e6)
    return Simulated(
        text, {"M": 4.0, "K": 800.0, "spring.viscous.f_v": 6.0}, ("--rate", "500", "--hold", "force=foh")
    )


def torsional_oscillator(seconds: float = SHORT) -> Simulated:
    t = clock(seconds)
    torque = lambda s: push(s, 1.0)  # noqa: E731
    q, _ = run(lambda s, x: [x[1], (torque(s) - 6.0 * x[0] - 0.03 * x[1]) / 0.02], [0.0, 0.0], t)
    text = table("time_ms torque_Nm twist_mrad", t * 1e3, torque(t), noisy(q) * 1e3, separator=" ")
    return Simulated(text, {"J": 0.02, "K": 6.0, "spring.viscous.f_v": 0.03}, ("--hold", "torque=foh"))


def two_inertias(seconds: float = SHORT) -> Simulated:
    t = clock(seconds)
    torque = lambda s: push(s, 2.0) + 0.7 * np.sin(2 * np.pi * 9.0 * s)  # noqa: E731

    def rates(s: float, x: np.ndarray) -> list[float]:
        spring = 50.0 * (x[0] - x[2]) + 0.05 * (x[1] - x[3])
        motor = torque(s) - spring - 0.1 * x[1] - 0.2 * sign(x[1], 3.0)
        return [x[1], motor / 0.01, x[3], spring / 0.05]

    motor, _, link, _ = run(rates, [0.0] * 4, t)
    text = table(
        "timestamp\ttau\tmotor_angle\tload_angle", t, torque(t), noisy(motor), noisy(link), separator="\t"
    )
    truth = {"J": 0.01, "I": 0.05, "K": 50.0, "motor.viscous.f_v": 0.1, "motor.coulomb.f_c": 0.2}
    return Simulated(text, {**truth, "spring.viscous.f_v": 0.05}, ("--hold", "torque=foh"))


def quarter_car(seconds: float = SHORT) -> Simulated:
    t = clock(seconds)
    # the road is band-limited, so that its samples tell it
    road = lambda s: push(s, 0.02) + 0.004 * np.sin(2 * np.pi * 7.0 * s)  # noqa: E731

    def rates(s: float, x: np.ndarray) -> list[float]:
        strut = 18e3 * (x[0] - x[2]) + 1500.0 * (x[1] - x[3])
        return [x[1], -strut / 300.0, x[3], (strut - 180e3 * (x[2] - road(s))) / 40.0]

    body, _, wheel, _ = run(rates, [road(0.0), 0.0, road(0.0), 0.0], t)
    text = table(
        "t [s],road [mm],body [mm],wheel [mm]", t, road(t) * 1e3, noisy(body) * 1e3, noisy(wheel) * 1e3
    )
    return Simulated(
        text,
        {"m_u": 40.0, "k_s": 18e3, "k_t": 180e3, "suspension.viscous.f_v": 1500.0},
        ("--hold", "road=foh"),
    )


def servo(seconds: float = SHORT) -> Simulated:
    t = clock(seconds)
    goal = 0.7 * np.sign(np.sin(2 * np.pi * 0.35 * t)) + 0.2 * np.sin(2 * np.pi * 1.1 * t)
    held = lambda s: goal[min(int(s * 500 + 1e-9), len(goal) - 1)]  # noqa: E731

    def rates(s: float, x: np.ndarray) -> list[float]:
        voltage = np.clip(48.0 * (held(s) - x[0]), -12, 12)
        torque = 0.8 * (voltage - 0.8 * x[1]) / 2.0 - 0.5 * np.sin(x[0])
        return [x[1], (torque - 0.1 * x[1] - 0.15 * sign(x[1], 3.0)) / 0.03]

    q, _ = run(rates, [0.0, 0.0], t)
    truth = {"J": 0.03, "G": 0.5, "joint.viscous.f_v": 0.1, "joint.coulomb.f_c": 0.15}
    return Simulated(
        table("time,goal_position,present_position", t, goal, noisy(q)),
        truth,
        (),
        ("parameters.k_t.fixed=0.8",),
    )


def test_rig(seconds: float = SHORT) -> Simulated:  # noqa: PT028
    """A rubber bushing: stiff, and viscous."""
    t = clock(seconds)
    w = 2 * np.pi * np.array([0.7, 1.9, 3.1])
    angle, size = w * t[:, None] + np.array([0.3, 1.0, 2.0]), 8e-3 * np.array([1.0, 0.5, 0.3])
    q, v = (size * np.sin(angle)).sum(axis=1), (size * w * np.cos(angle)).sum(axis=1)
    force = 2.0 * -(size * w**2 * np.sin(angle)).sum(axis=1) + 5e3 * q + 60.0 * v
    text = table("time [s],LVDT [mm],load cell [kN]", t, noisy(q) * 1e3, noisy(force, 1e-3) / 1e3)
    return Simulated(text, {"M": 2.0, "K": 5e3, "specimen.viscous.f_v": 60.0})


def vehicle(seconds: float = SHORT) -> Simulated:
    """A model car, never at rest. The speed is measured."""
    t = clock(seconds)
    force = lambda s: 20.0 + push(s, 60.0)  # noqa: E731
    v, _ = run(lambda s, x: [(force(s) - 4.0 - 0.5 * x[0] - 0.12 * x[0] ** 2) / 4.0, 0.0], [6.0, 0.0], t)
    text = table("ts,drive force (N),speed_kmh", 1.7e9 + t, force(t), noisy(v) * 3.6, digits=14)
    truth = {"M": 4.0, "road.coulomb.f_c": 4.0, "road.viscous.f_v": 0.5, "road.quadratic_drag.c_d": 0.12}
    return Simulated(text, truth, ("--hold", "force=foh"))


def spindle(seconds: float = SHORT) -> Simulated:
    t = clock(seconds)
    torque = lambda s: push(s, 2.0)  # noqa: E731
    w, _ = run(lambda s, x: [(torque(s) - 5e-3 * x[0] - 0.2 * sign(x[0], 60.0)) / 5e-3, 0.0], [0.0, 0.0], t)
    text = table(
        "Zeit [s];Drehmoment [Nm];Drehzahl [U/min]", t, torque(t), noisy(w) * 30 / np.pi, separator=";"
    )
    truth = {"J": 5e-3, "bearing.viscous.f_v": 5e-3, "bearing.coulomb.f_c": 0.2}
    return Simulated(text, truth, ("--hold", "torque=foh"))


def dc_motor(seconds: float = SHORT) -> Simulated:
    t = clock(seconds)
    voltage = lambda s: push(s, 12.0)  # noqa: E731

    def rates(s: float, x: np.ndarray) -> list[float]:
        motor = 0.05 * (voltage(s) - 0.05 * x[0]) / 1.2
        return [(motor - 1e-4 * x[0] - 0.02 * sign(x[0], 150.0)) / 2e-4, 0.0]

    w, _ = run(rates, [0.0, 0.0], t)
    text = table("time [s],voltage [V],speed [rpm]", t, voltage(t), noisy(w) * 30 / np.pi)
    truth = {"J": 2e-4, "bearing.viscous.f_v": 1e-4, "bearing.coulomb.f_c": 0.02}
    known = ("parameters.k.fixed=0.05", "parameters.R.fixed=1.2")
    return Simulated(text, truth, ("--hold", "voltage=foh"), known)


def blank(seconds: float = SHORT) -> Simulated:
    t = clock(seconds)
    drive = lambda s: push(s, 1.0)  # noqa: E731
    q, _ = run(lambda s, x: [x[1], 5.0 * drive(s) - 1.0 * x[1]], [0.0, 0.0], t)
    return Simulated(
        table("t,u,y", t, drive(t), noisy(q)), {"b": 5.0, "joint.viscous.f_v": 1.0}, ("--hold", "input=foh")
    )


def slide(seconds: float = 20.0) -> Simulated:
    """A carriage whose viscous friction differs by direction, which the template does not declare."""
    t = clock(seconds)
    force = lambda s: push(s, 10.0)  # noqa: E731
    friction = lambda v: 3.0 * v + 0.4 * abs(v) + 1.5 * sign(v, 0.9)  # noqa: E731
    q, _ = run(lambda s, x: [x[1], (force(s) - friction(x[1])) / 2.0], [0.0, 0.0], t)
    text = table("t_ms,motor current [A],Position (mm)", t * 1000, force(t) / 2.5, noisy(q) * 1000)
    truth = {"guide.asymmetric_viscous.df_v": -0.8}  # backward less forward
    return Simulated(text, truth, ("--scale", "force=2.5", "--hold", "force=foh"))


MACHINES: Mapping[str, Callable[..., Simulated]] = {
    one.__name__: one
    for one in (
        slide,
        carriage,
        rotary,
        driven_pendulum,
        pendulum,
        oscillator,
        torsional_oscillator,
        two_inertias,
        quarter_car,
        tank,
        two_tanks,
        heater,
        room,
        servo,
        test_rig,
        vehicle,
        spindle,
        dc_motor,
        blank,
    )
}
