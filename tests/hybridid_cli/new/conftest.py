"""Simulated recordings of the machines that the templates describe, by scipy alone, as a logger writes them.

Each is 5 s at 500 Hz (the tank: 1,000 s at 1 Hz), with the noise of a good sensor. Units, names and
separators differ from one to the next.
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cache

import numpy as np
import pytest
from scipy.integrate import solve_ivp

STICK = 2e-3  # of the usual speed: smooths sign(v)


@dataclass(frozen=True)
class Simulated:
    """A recording's text, what ``new`` needs to be told beside it, and the truth by parameter."""

    text: str
    truth: Mapping[str, float]
    words: tuple[str, ...] = ()
    settings: tuple[str, ...] = ()


def _time(duration: float = 5.0, rate: float = 500.0) -> np.ndarray:
    return np.arange(0, duration, 1 / rate)


def _run(rates: Callable, start: list[float], t: np.ndarray) -> np.ndarray:
    done = solve_ivp(rates, (t[0], t[-1]), start, t_eval=t, max_step=2 * (t[1] - t[0]), rtol=1e-7, atol=1e-9)
    assert done.success
    return done.y


def _noisy(signal: np.ndarray, share: float = 2e-4) -> np.ndarray:
    return signal + np.random.default_rng(7).normal(0, share * np.std(signal), signal.shape)


def _push(t: np.ndarray | float, size: float) -> np.ndarray | float:
    return size * (0.6 * np.sin(2 * np.pi * 0.5 * t) + 0.4 * np.sin(2 * np.pi * 1.3 * t + 1.0))


def _sign(v: np.ndarray, usual: float) -> np.ndarray:
    return np.tanh(v / (STICK * usual))


def _table(header: str, *columns: np.ndarray, separator: str = ",", decimal: str = ".") -> str:
    rows = [
        separator.join(f"{value:.9g}".replace(".", decimal) for value in row)
        for row in zip(*columns, strict=True)
    ]
    return "\n".join([header, *rows]) + "\n"


def carriage() -> Simulated:
    t = _time()
    force = lambda s: _push(s, 10.0)  # noqa: E731
    q, _ = _run(lambda s, x: [x[1], (force(s) - 3.0 * x[1] - 1.5 * _sign(x[1], 0.9)) / 2.0], [0.0, 0.0], t)
    text = _table("t_ms,motor current [A],Position (mm)", t * 1000, force(t) / 2.5, _noisy(q) * 1000)
    truth = {"M": 2.0, "guide.viscous.f_v": 3.0, "guide.coulomb.f_c": 1.5}
    return Simulated(text, truth, ("--scale", "force=2.5", "--hold", "force=foh"))


def rotary() -> Simulated:
    t = _time()
    torque = lambda s: _push(s, 0.5)  # noqa: E731
    q, _ = _run(
        lambda s, x: [x[1], (torque(s) - 0.05 * x[1] - 0.06 * _sign(x[1], 3.0)) / 0.02], [0.0, 0.0], t
    )
    text = _table(
        "Zeit;Drehmoment_mNm;Winkel [°]",
        t,
        torque(t) * 1000,
        np.degrees(_noisy(q)),
        separator=";",
        decimal=",",
    )
    truth = {"J": 0.02, "joint.viscous.f_v": 0.05, "joint.coulomb.f_c": 0.06}
    return Simulated(text, truth, ("--hold", "torque=foh"))


def pendulum() -> Simulated:
    t = _time()
    q, _ = _run(lambda s, x: [x[1], -20.0 * np.sin(x[0] - 0.02) - 0.1 * x[1]], [0.8, 0.0], t)
    return Simulated(
        _table("time,angle_deg", t, np.degrees(_noisy(q))), {"G": 20.0, "q_0": 0.02, "pivot.viscous.f_v": 0.1}
    )


def oscillator() -> Simulated:
    t = _time()
    force = lambda s: _push(s, 20.0)  # noqa: E731
    q, _ = _run(lambda s, x: [x[1], (force(s) - 800.0 * x[0] - 6.0 * x[1]) / 4.0], [0.0, 0.0], t)
    text = _table("F [kN],x [µm]", force(t) / 1000, _noisy(q) * 1e6)
    return Simulated(
        text, {"M": 4.0, "K": 800.0, "spring.viscous.f_v": 6.0}, ("--rate", "500", "--hold", "force=foh")
    )


def two_inertias() -> Simulated:
    t = _time()
    torque = lambda s: _push(s, 2.0) + 0.7 * np.sin(2 * np.pi * 9.0 * s)  # noqa: E731

    def rates(s: float, x: np.ndarray) -> list[float]:
        spring = 50.0 * (x[0] - x[2]) + 0.05 * (x[1] - x[3])
        motor = torque(s) - spring - 0.1 * x[1] - 0.2 * _sign(x[1], 3.0)
        return [x[1], motor / 0.01, x[3], spring / 0.05]

    motor, _, link, _ = _run(rates, [0.0] * 4, t)
    text = _table(
        "timestamp\ttau\tmotor_angle\tload_angle", t, torque(t), _noisy(motor), _noisy(link), separator="\t"
    )
    truth = {"J": 0.01, "I": 0.05, "K": 50.0, "motor.viscous.f_v": 0.1, "motor.coulomb.f_c": 0.2}
    return Simulated(text, {**truth, "spring.viscous.f_v": 0.05}, ("--hold", "torque=foh"))


def quarter_car() -> Simulated:
    t = _time()
    # the road is band-limited, so that its samples tell it
    road = lambda s: _push(s, 0.02) + 0.004 * np.sin(2 * np.pi * 7.0 * s)  # noqa: E731

    def rates(s: float, x: np.ndarray) -> list[float]:
        strut = 18e3 * (x[0] - x[2]) + 1500.0 * (x[1] - x[3])
        return [x[1], -strut / 300.0, x[3], (strut - 180e3 * (x[2] - road(s))) / 40.0]

    body, _, wheel, _ = _run(rates, [road(0.0), 0.0, road(0.0), 0.0], t)
    text = _table(
        "t [s],road [mm],body [mm],wheel [mm]", t, road(t) * 1e3, _noisy(body) * 1e3, _noisy(wheel) * 1e3
    )
    return Simulated(
        text,
        {"m_u": 40.0, "k_s": 18e3, "k_t": 180e3, "suspension.viscous.f_v": 1500.0},
        ("--hold", "road=foh"),
    )


def tank() -> Simulated:
    t = _time(1000.0, 1.0)
    flow = 2e-4 * (1 + 0.6 * np.sign(np.sin(2 * np.pi * t / 250)))  # held between the samples
    level = np.empty_like(t)
    level[0] = 0.1
    for k, held in enumerate(flow[:-1]):
        fill = lambda s, h, inflow: [(inflow - 4e-4 * np.sqrt(max(h[0], 0))) / 0.02]  # noqa: E731
        level[k + 1] = solve_ivp(fill, (0, 1), [level[k]], args=(held,), rtol=1e-9).y[0, -1]
    text = _table("time,pump [L/min],level [cm]", t, flow * 6e4, _noisy(level) * 100)
    return Simulated(text, {"A": 0.02, "c": 4e-4})


def servo() -> Simulated:
    t = _time()
    goal = 0.7 * np.sign(np.sin(2 * np.pi * 0.35 * t)) + 0.2 * np.sin(2 * np.pi * 1.1 * t)
    held = lambda s: goal[min(int(s * 500 + 1e-9), len(goal) - 1)]  # noqa: E731

    def rates(s: float, x: np.ndarray) -> list[float]:
        voltage = np.clip(48.0 * (held(s) - x[0]), -12, 12)
        torque = 0.8 * (voltage - 0.8 * x[1]) / 2.0 - 0.5 * np.sin(x[0])
        return [x[1], (torque - 0.1 * x[1] - 0.15 * _sign(x[1], 3.0)) / 0.03]

    q, _ = _run(rates, [0.0, 0.0], t)
    truth = {"J": 0.03, "G": 0.5, "joint.viscous.f_v": 0.1, "joint.coulomb.f_c": 0.15}
    return Simulated(
        _table("time,goal_position,present_position", t, goal, _noisy(q)),
        truth,
        (),
        ("parameters.k_t.fixed=0.8",),
    )


def test_rig() -> Simulated:
    """A rubber bushing: stiff, and viscous."""
    t = _time()
    w = 2 * np.pi * np.array([0.7, 1.9, 3.1])
    angle, size = w * t[:, None] + np.array([0.3, 1.0, 2.0]), 8e-3 * np.array([1.0, 0.5, 0.3])
    q, v = (size * np.sin(angle)).sum(axis=1), (size * w * np.cos(angle)).sum(axis=1)
    force = 2.0 * -(size * w**2 * np.sin(angle)).sum(axis=1) + 5e3 * q + 60.0 * v
    text = _table("time [s],LVDT [mm],load cell [kN]", t, _noisy(q) * 1e3, _noisy(force, 1e-3) / 1e3)
    return Simulated(text, {"M": 2.0, "K": 5e3, "specimen.viscous.f_v": 60.0})


def blank() -> Simulated:
    t = _time()
    drive = lambda s: _push(s, 1.0)  # noqa: E731
    q, _ = _run(lambda s, x: [x[1], 5.0 * drive(s) - 1.0 * x[1]], [0.0, 0.0], t)
    return Simulated(
        _table("t,u,y", t, drive(t), _noisy(q)), {"b": 5.0, "joint.viscous.f_v": 1.0}, ("--hold", "input=foh")
    )


def slide() -> Simulated:
    """A carriage whose viscous friction differs by direction, which the template does not declare."""
    t = _time(20.0)
    force = lambda s: _push(s, 10.0)  # noqa: E731
    friction = lambda v: 3.0 * v + 0.4 * abs(v) + 1.5 * _sign(v, 0.9)  # noqa: E731
    q, _ = _run(lambda s, x: [x[1], (force(s) - friction(x[1])) / 2.0], [0.0, 0.0], t)
    text = _table("t_ms,motor current [A],Position (mm)", t * 1000, force(t) / 2.5, _noisy(q) * 1000)
    return Simulated(text, {"guide.asymmetric_viscous.df_v": 0.4})


MACHINES: Mapping[str, Callable[[], Simulated]] = {
    one.__name__: one
    for one in (
        slide,
        carriage,
        rotary,
        pendulum,
        oscillator,
        two_inertias,
        quarter_car,
        tank,
        servo,
        test_rig,
        blank,
    )
}


@pytest.fixture(scope="session")
def machine() -> Callable[[str], Simulated]:
    """A machine's recording by the template's name, simulated once."""
    return cache(lambda kind: MACHINES[kind]())


@pytest.fixture
def recorded(machine, own_folder) -> Callable[[str], tuple[str, ...]]:
    """Writes ``kind.csv`` and gives the words that ``hybridid new`` needs for it."""

    def written(kind: str) -> tuple[str, ...]:
        (own_folder / f"{kind}.csv").write_text(machine(kind).text, encoding="utf-8")
        return ("--from", f"{kind}.csv", "--template", kind, *machine(kind).words)

    return written


@pytest.fixture
def rig(request) -> str:
    """A name for the machine that no other test uses: a module that was imported stays in the process."""
    return f"rig_{hashlib.sha256(request.node.nodeid.encode()).hexdigest()[:10]}"
