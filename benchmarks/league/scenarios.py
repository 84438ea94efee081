"""The league's scenarios: what is planted where, in two sizes, under which noise."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from benchmarks.league.planting import Hidden
from benchmarks.league.scenario import Scenario

Sized = tuple[Hidden, Hidden]
SIZES = ("small", "large")
CLEAN = {
    "carriage": 1e-7, "carriage_open": 1e-7, "carriage_level": 1e-7, "oscillator": 2e-5,
    "flexible_link": 2e-5, "esea": 2e-5, "half_car": 2e-4,
}  # fmt: skip
"""Standard deviation of the sensor's noise that counts as clean: m, V, rad, rad, and m/s of the half-car."""
NOISY = (5e-6, 2e-5, 1e-4)
"""Of the carriage's position [m]: with ``CLEAN`` three decades."""


def _both(what: str, port: str, small: dict[str, float], **large: float) -> Sized:
    """The effect at its small values, and with those in ``large`` instead."""
    return Hidden(what, port, small), Hidden(what, port, {**small, **large})


def _carriage(what: str, small: dict[str, float], **large: float) -> Sized:
    return _both(what, "carriage", small, **large)


STATIC = (
    _carriage("asymmetric_viscous", {"difference": 20.0}, difference=70.0),
    _carriage("stribeck", {"amplitude": 3.0, "velocity": 0.03}, amplitude=10.0),
    _carriage("quadratic_drag", {"c": 100.0}, c=400.0),
    _carriage("linear_stiffness", {"k": 20.0, "q_0": 0.0}, k=100.0),
    _carriage("cubic_stiffness", {"k_3": 2000.0, "q_0": 0.1}, k_3=8000.0),
    _carriage("cogging", {"amplitude": 1.5, "pitch": 0.02, "phase": 0.3}, amplitude=5.0),
    _carriage("position_friction", {"slope": 20.0, "q_0": 0.0}, slope=60.0),
    _carriage("friction_drift", {"rate": 0.4}, rate=1.2),
    _carriage("end_stop", {"k": 500.0, "d": 0.18}, k=2000.0),
    _both("input_dead_zone", "force", {"dead_zone": 3.0}, dead_zone=8.0),
    _both("input_saturation", "force", {"limit": 100.0}, limit=80.0),
)
LEVEL = (
    _carriage("offset", {"offset": 2.0}, offset=6.0),
    _carriage("asymmetric_coulomb", {"difference": 4.0}, difference=12.0),
)
MEMORY = (
    _carriage("dahl", {"amplitude": 5.0, "stiffness": 2500.0}, amplitude=15.0, stiffness=7500.0),
    _carriage(
        "lugre",
        {"f_c": 5.0, "f_s": 7.5, "v_s": 0.03, "sigma_0": 5e3, "sigma_1": 20.0},
        f_c=12.0, f_s=18.0, sigma_0=1.2e4, sigma_1=50.0,
    ),
    _carriage("bouc_wen", {"f_c": 5.0, "s": 0.01, "sigma": 0.7}, f_c=15.0),
    _carriage("maxwell", {"k": 150.0, "tau": 0.3}, k=600.0),
    _carriage("flexible_mode", {"mass": 8.0, "frequency": 8.0, "damping": 0.05}, mass=25.0),
    _carriage(
        "backlash", {"mass": 8.0, "frequency": 20.0, "damping": 0.3, "gap": 5e-4}, mass=20.0, gap=1e-3
    ),
)  # fmt: skip
LATE = (
    _both("input_delay", "force", {"delay": 1.5e-3}, delay=5e-3),
    _both("input_lag", "force", {"lag": 2e-3}, lag=1e-2),
    _both("sensor_lag", "position", {"lag": 2e-3}, lag=1e-2),
)
OUTSIDE = (
    _carriage("eddy_brake", {"peak": 4.0, "v_c": 0.08}, peak=12.0),
    _carriage("heating", {"c": 8.0, "tau": 3.0}, c=25.0),
    _carriage("dent", {"amplitude": 4.0, "q_0": 0.09, "width": 0.012}, amplitude=12.0),
    _carriage("position_damping", {"c": 150.0}, c=600.0),
    _carriage("step_disturbance", {"amplitude": 2.0, "instant": 4.0}, amplitude=6.0),
)
OSCILLATOR = (
    _both("cubic_stiffness", "oscillator", {"k_3": 1.0, "q_0": 0.0}, k_3=4.0),
    _both("quadratic_drag", "oscillator", {"c": 1e-6}, c=5e-6),
    _both("coulomb", "oscillator", {"f_c": 3e-4}, f_c=1.5e-3),
)
LINK = (
    _both("coulomb", "servo", {"f_c": 0.01}, f_c=0.03),
    _both("cubic_stiffness", "link", {"k_3": 10.0, "q_0": 0.0}, k_3=40.0),
    _both("linear_stiffness", "servo", {"k": 0.01, "q_0": 0.0}, k=0.05),
)
ESEA = (
    _both("coulomb", "motor", {"f_c": 0.01}, f_c=0.04),
    _both("cubic_stiffness", "elastomer", {"k_3": 300.0, "q_0": 0.0}, k_3=1200.0),
    _both("viscous", "elastomer", {"f_v": 0.02}, f_v=0.06),
    _both("maxwell", "elastomer", {"k": 2.0, "tau": 0.03}, k=6.0),
    _both("coulomb", "link", {"f_c": 0.006}, f_c=0.03),
    _both("cogging", "motor", {"amplitude": 0.02, "pitch": 3.1416, "phase": 0.3}, amplitude=0.06),
    _both("input_gain", "torque", {"gain": 0.98}, gain=0.92),
)
HALF_CAR = (
    _both("asymmetric_damper", "front_suspension", {"difference": 500.0, "knee": 0.05}, difference=2000.0),
    _both("asymmetric_damper", "rear_suspension", {"difference": 500.0, "knee": 0.05}, difference=1800.0),
    _both("cubic_stiffness", "front_suspension", {"k_3": 5e5, "q_0": 0.0}, k_3=2e6),
    _both("cubic_stiffness", "rear_suspension", {"k_3": 1e6, "q_0": 0.0}, k_3=4e6),
    _both("coulomb", "rear_suspension", {"f_c": 80.0}, f_c=300.0),
    _both("wheel_lift_off", "front_tyre", {"k": 5.2e5, "d": 0.0132}, d=0.008),
)
PARTLY_OUTSIDE = (
    ("esea", _both("dent", "motor", {"amplitude": 0.03, "q_0": 0.1, "width": 0.08}, amplitude=0.1)),
    ("half_car", _both("blow_off", "front_suspension", {"c": 900.0, "v_b": 0.3}, c=1600.0)),
)
DECOYS = (
    *(("carriage", noise, {}) for noise in (1e-7, 1e-6, *NOISY)),
    *(("carriage", noise, {"noise_memory": 0.9}) for noise in (5e-6, 2e-5)),
    ("carriage", 2e-6, {"noise_in_loop": True}),
    *(("carriage_open", noise, {}) for noise in (1e-7, 5e-6, 1e-4)),
    ("carriage_level", 1e-7, {}),
    *(("oscillator", noise, {}) for noise in (2e-5, 1e-3)),
    *(("flexible_link", noise, {}) for noise in (2e-5, 1e-3)),
    *(("esea", noise, {}) for noise in (2e-5, 2e-4)),
    *(("half_car", noise, {}) for noise in (2e-4, 2e-3)),
)


def all_scenarios() -> tuple[Scenario, ...]:
    """Every scenario, its seed its number: no two share their noise."""
    made = [
        Scenario(machine, category, hidden, size, noise, seed, **more)
        for seed, (machine, category, hidden, size, noise, more) in enumerate(_rows())
    ]
    keys = [one.key for one in made]
    assert len(set(keys)) == len(keys), "two scenarios are one"
    return tuple(made)


def _rows() -> Iterator[tuple]:
    yield from _planted("clean", "carriage", STATIC)
    yield from _planted("clean", "carriage_open", (STATIC[0], STATIC[1], STATIC[2], STATIC[4], STATIC[5]))
    yield from _planted("clean", "carriage_level", LEVEL)
    yield from _planted("clean", "oscillator", OSCILLATOR)
    yield from _planted("clean", "flexible_link", LINK)
    yield from _noisy()
    yield from _planted("partly_measured", "esea", ESEA)
    yield from _planted("partly_measured", "half_car", HALF_CAR)
    yield from _large("partly_measured", "esea", (ESEA[0], ESEA[3]), 10 * CLEAN["esea"])
    yield from _large("partly_measured", "half_car", (HALF_CAR[0], HALF_CAR[3]), 10 * CLEAN["half_car"])
    for category, what in (("memory", MEMORY), ("delay_or_lag", LATE)):
        yield from _planted(category, "carriage", what)
        yield from _large(category, "carriage_open", what, CLEAN["carriage_open"])
        yield from _large(category, "carriage", what, NOISY[0])
    yield from _planted("outside", "carriage", OUTSIDE)
    yield from _large("outside", "carriage", OUTSIDE, NOISY[1])
    for machine, sized in PARTLY_OUTSIDE:
        yield from _planted("outside", machine, (sized,))
    for machine, noise, more in DECOYS:
        yield machine, "nothing", (), "none", noise, more


def _noisy() -> Iterator[tuple]:
    """Each effect of the carriage under the least and the most noise, or under that between."""
    for k, sized in enumerate(STATIC):
        for noise in (NOISY[0], NOISY[2]) if k % 2 == 0 else NOISY[1:2]:
            yield from _large("noisy", "carriage", (sized,), noise)
    yield from _large("noisy", "carriage", STATIC[:1], 2e-6, noise_in_loop=True)
    yield from _large("noisy", "carriage", STATIC[2:3], 2e-5, noise_memory=0.9)
    yield from _large("noisy", "carriage_open", (STATIC[1], STATIC[2], STATIC[4]), 2e-5)
    yield from _large("noisy", "oscillator", OSCILLATOR[:1], 1e-3)
    yield from _large("noisy", "flexible_link", LINK[:1], 1e-3)


def _large(
    category: str, machine: str, what: Sequence[Sized], noise: float, **more: float
) -> Iterator[tuple]:
    for _, hidden in what:
        yield machine, category, (hidden,), "large", noise, more


def _planted(category: str, machine: str, what: tuple[Sized, ...]) -> Iterator[tuple]:
    for sized in what:
        for size, hidden in zip(SIZES, sized, strict=True):
            yield machine, category, (hidden,), size, CLEAN[machine], {}
