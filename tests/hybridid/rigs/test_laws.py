"""Each law of the truth against its textbook form, and the values a law may be given."""

from __future__ import annotations

import numpy as np
import pytest

from hybridid.rigs.law_library import LAWS, law_named, plant
from hybridid.rigs.laws import Law, Planted, RigError

DRIVE, LOAD = 4.0, -7.0  # N, what the contact carries
# (values, F(t, q, v) with sign and modulus as textbooks write them)
TEXTBOOK = {
    "viscous": ({"f_v": 203.0}, lambda t, q, v: 203.0 * v),
    "coulomb": ({"f_c": 20.0}, lambda t, q, v: 20.0 * np.sign(v)),
    "offset": ({"offset": -3.0}, lambda t, q, v: -3.0),
    "stiffness": ({"k": 7.0, "q_0": 0.1}, lambda t, q, v: 7.0 * (q - 0.1)),
    "asymmetric_viscous": ({"difference": 70.0}, lambda t, q, v: (35.0 if v < 0 else -35.0) * v),
    "asymmetric_coulomb": ({"difference": 6.0}, lambda t, q, v: (3.0 if v < 0 else -3.0) * np.sign(v)),
    "stribeck": (
        {"amplitude": 5.0, "velocity": 0.02},
        lambda t, q, v: 5.0 * np.exp(-((v / 0.02) ** 2)) * np.sign(v),
    ),
    "quadratic_drag": ({"c": 40.0}, lambda t, q, v: 40.0 * v * abs(v)),
    "cubic_stiffness": ({"k_3": 900.0, "q_0": 0.1}, lambda t, q, v: 900.0 * (q - 0.1) ** 3),
    "cogging": (
        {"amplitude": 2.0, "pitch": 0.02, "phase": 0.3},
        lambda t, q, v: 2.0 * np.sin(2 * np.pi * q / 0.02 + 0.3),
    ),
    "position_friction": ({"slope": 30.0, "q_0": 0.1}, lambda t, q, v: 30.0 * (q - 0.1) * np.sign(v)),
    "friction_drift": ({"rate": 0.5}, lambda t, q, v: 0.5 * t * np.sign(v)),
    "asymmetric_damper": (
        {"difference": 70.0, "knee": 0.02},
        lambda t, q, v: -35.0 * (np.hypot(v, 0.02) - 0.02),
    ),
    "wheel_lift_off": ({"k": 900.0, "d": 0.3}, lambda t, q, v: 0.0),
    "weight": ({"amplitude": 2.0, "q_0": 0.3}, lambda t, q, v: 2.0 * np.sin(q - 0.3)),
    "load_friction": ({"mu": 0.1}, lambda t, q, v: 0.1 * abs(DRIVE - LOAD) * np.sign(v)),
    "load_stribeck": (
        {"mu": 0.1, "velocity": 0.02},
        lambda t, q, v: 0.1 * abs(DRIVE - LOAD) * np.exp(-((v / 0.02) ** 2)) * np.sign(v),
    ),
    "two_sided_load_friction": (
        {"mu_drive": 0.1, "mu_load": 0.2},
        lambda t, q, v: (0.1 * abs(DRIVE) + 0.2 * abs(LOAD)) * np.sign(v),
    ),
}
HAS_MEMORY = {"dahl", "flexible_mode", "maxwell", "lugre"}


def force(planted: Planted, t, q, v, z=()):
    rates = np.zeros(planted.law.states)
    carried = [DRIVE, LOAD] if planted.law.loaded else []
    values = np.array([*(value for _, value in planted.values), *carried])
    return planted.law.function(t, q, v, np.sign(v), np.array(z, dtype=float), values, rates), rates


def test_every_law_is_checked_here():
    assert {law.name for law in LAWS} == set(TEXTBOOK) | HAS_MEMORY
    assert len({law.name for law in LAWS}) == len(LAWS)


@pytest.mark.parametrize("name", TEXTBOOK)
@pytest.mark.parametrize("v", [-0.1, -0.015, 0.012, 0.1])
def test_a_law_is_its_textbook_equation(name, v):
    values, textbook = TEXTBOOK[name]
    assert force(plant(name, **values), 2.0, 0.17, v)[0] == pytest.approx(textbook(2.0, 0.17, v), rel=1e-12)


@pytest.mark.parametrize("v", [-0.1, 0.1])
def test_dahl_bristle_saturates_at_its_amplitude_in_both_directions(v):
    planted = plant("dahl", amplitude=5.0, stiffness=1e5)
    resisting, rates = force(planted, 0, 0, v, [0.4])
    assert resisting == pytest.approx(2.0)
    assert rates == pytest.approx([1e5 / 5.0 * (v - 0.1 * 0.4)])
    assert force(planted, 0, 0, v, [np.sign(v)])[1] == pytest.approx([0.0])


def test_a_tyre_off_the_road_neither_pulls_nor_pushes():
    """k q about a static load k d: what is left below q = -d is the load with its sign turned."""
    for q in (-0.5, -0.31, -0.29, 0.2):
        lift_off, _ = force(plant("wheel_lift_off", k=900.0, d=0.3), 0, q, 0.1)
        assert 900.0 * q + lift_off == pytest.approx(max(900.0 * q, -900.0 * 0.3))


def test_a_maxwell_branch_is_a_spring_that_relaxes():
    resisting, rates = force(plant("maxwell", k=6.0, tau=0.03), 0, 0, 0.5, [0.01])
    assert resisting == pytest.approx(0.06)
    assert rates == pytest.approx([0.5 - 0.01 / 0.03])


@pytest.mark.parametrize("v", [-0.7, 0.7])
def test_lugre_friction_settles_at_its_stribeck_curve(v):
    values = {"f_c": 0.045, "f_s": 0.06, "v_s": 1.0, "sigma_0": 9.0, "sigma_1": 0.01}
    curve = 0.045 + 0.015 * np.exp(-(0.7**2))
    resisting, rates = force(plant("lugre", **values), 0, 0, v, [np.sign(v) * curve / 9.0])
    assert rates == pytest.approx([0.0], abs=1e-15)
    assert resisting == pytest.approx(np.sign(v) * curve)
    resisting, rates = force(plant("lugre", **values), 0, 0, v, [0.001])
    assert rates == pytest.approx([v - 9.0 * 0.7 * 0.001 / curve])
    assert resisting == pytest.approx(0.009 + 0.01 * rates[0])


@pytest.mark.parametrize("law", [law for law in LAWS if not law.sided], ids=lambda law: law.name)
def test_a_law_said_to_have_no_side_has_none(law):
    values = np.full(len(law.parameters), 0.3)
    sides = []
    for s in (-1.0, 0.0, 1.0):
        rates = np.zeros(law.states)
        sides.append((law.function(0.5, -0.7, 0.2, s, np.full(law.states, 0.1), values, rates), *rates))
    assert sides[0] == sides[1] == sides[2]
    assert not law.dry


def test_an_appended_mass_pulls_back_what_accelerates_it():
    planted = plant("flexible_mode", mass=4.0, frequency=10.0, damping=0.05)
    omega = 20 * np.pi
    resisting, (deflection_rate, acceleration) = force(planted, 0, 0, 0.2, [1e-3, 0.5])
    assert deflection_rate == pytest.approx(0.3)
    assert acceleration == pytest.approx(-(omega**2) * 1e-3 - 0.1 * omega * 0.3)
    assert resisting == pytest.approx(4.0 * acceleration)


@pytest.mark.parametrize(
    ("make", "said"),
    [
        (lambda: plant("stribek", amplitude=1.0), "no law 'stribek' to plant; nearest: stribeck"),
        (
            lambda: plant("stribeck", amplitud=1.0),
            "no parameter 'amplitud'; nearest: amplitude",
        ),
        (
            lambda: plant("stribeck", amplitude=1.0),
            r"missing; it needs amplitude \[N\], velocity \[m/s\]",
        ),
        (lambda: plant("stribeck", amplitude=1.0, velocity=0.0), "velocity is 0, must be above 0"),
        (lambda: plant("coulomb", f_c=float("nan")), "f_c is nan, must be finite"),
    ],
)
def test_a_wrong_law_is_refused_in_one_line(make, said):
    with pytest.raises(RigError, match=said) as refused:
        make()
    assert "\n" not in str(refused.value)


def test_values_keep_the_order_of_the_law():
    planted = plant("stribeck", velocity=0.02, amplitude=5)
    assert planted.values == (("amplitude", 5.0), ("velocity", 0.02))
    assert planted == plant("stribeck", amplitude=5.0, velocity=0.02)


def test_a_law_that_computes_something_else_has_another_fingerprint():
    coulomb = law_named("coulomb")
    other = Law("coulomb", coulomb.equation, _softer, coulomb.parameters, dry=True)
    assert other.fingerprint != coulomb.fingerprint
    assert law_named("coulomb").fingerprint == coulomb.fingerprint


def _softer(t, q, v, s, z, p, dz):
    return 0.9 * p[0] * s
