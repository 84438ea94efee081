"""What each law is: its units, its symmetry, whether it takes, keeps or stores energy, and its rig's twin."""

from __future__ import annotations

import numpy as np
import pytest

from hybridid.effects.dimension import Dimension
from hybridid.effects.library import EFFECTS, effect_named
from hybridid.rigs.law_library import law_named

# how time, effort and position are measured in another system of units
LENGTH, FORCE, SECONDS = 7.0, 3.0, 11.0
OF_SEEN = {
    "time": (0, 0, 1),
    "epsilon": (0, 1, -1),
    "position": (0, 1, 0),
    "velocity": (0, 1, -1),
    "acceleration": (0, 1, -2),
    "signal": (1, 0, 0),
    "drive": (1, 0, 0),
    "load": (1, 0, 0),
    "level": (0, 0, 0),
    "load_width": (1, 0, 0),
}
RATE = Dimension(time=-1)


def factor(dimension: Dimension, length: float) -> float:
    return FORCE**dimension.effort * length**dimension.position * SECONDS**dimension.time


def test_laws_are_dimensionally_consistent(any_bench):
    """In other units of effort, length and time every law and rate is the same number of the new unit."""
    bench, effect = any_bench, any_bench.effect
    length = 1.0 if effect.position_units else LENGTH  # an angle has no unit to change
    rng = np.random.default_rng(4)
    into = {name: factor(Dimension(*powers), length) for name, powers in OF_SEEN.items()}
    for _ in range(5):
        seen = {name: rng.normal() for name in OF_SEEN} | {"epsilon": 0.05, "load_width": 0.1}
        z = rng.uniform(-0.9, 0.9, len(effect.states)) * [s.at(bench.port).scale for s in effect.states]
        law, rates = bench(z, **seen)
        p = {q.name: bench.p[q.name] * factor(q.dimension, length) for q in effect.parameters}
        z_new = [value * factor(s.dimension, length) for value, s in zip(z, effect.states, strict=True)]
        law_new, rates_new = bench(z_new, p, **{name: value * into[name] for name, value in seen.items()})
        assert law_new == pytest.approx(law * FORCE, rel=1e-6)
        expected = [
            r * factor(s.dimension, length) / SECONDS for r, s in zip(rates, effect.states, strict=True)
        ]
        assert rates_new == pytest.approx(expected, rel=1e-6)


LOADED = ("load_friction", "load_stribeck", "two_sided_load_friction", "input_scaled_friction")
ODD_IN_VELOCITY = (
    *("viscous", "coulomb", "stribeck", "quadratic_drag", "position_friction", "friction_drift"),
    *("friction_beyond_gap", "cyclic_friction"),
    *("eddy_brake", "position_damping", "blow_off_valve", "centrifugal_brake"),
    *LOADED,
)
CARRIED = {"drive": 2.0, "load": 3.5, "level": 0.7}
EVEN_IN_VELOCITY = (
    *("asymmetric_viscous", "asymmetric_coulomb", "asymmetric_damper"),
    *("varying_inertia", "cyclic_inertia"),
)
BLIND_TO_VELOCITY = (
    *("offset", "cogging", "periodic_disturbance", "linear_stiffness", "cubic_stiffness", "free_play"),
    *("gravity", "end_stop", "wheel_lift_off", "added_inertia", "detent", "preloaded_spring"),
    *("overflow", "overflow_into", "orifice_leak", "linear_leak", "steady_leak", "periodic_flow"),
    *("varying_force_factor", "torque_ripple", "natural_convection", "thermal_radiation"),
    "falling_supply",
)
BRANCHES = ("maxwell", "second_maxwell", "third_maxwell")
REMEMBERING = ("dahl", "lugre", "bouc_wen", *BRANCHES, "flexible_mode", "friction_behind_play")
ODD_ALTOGETHER = (*REMEMBERING, "backlash", "hardening_hysteresis", "side_capacity")
OF_THE_SPEED = ("warming_friction", "back_emf_limit")


@pytest.mark.parametrize("name", ODD_IN_VELOCITY + EVEN_IN_VELOCITY + BLIND_TO_VELOCITY)
def test_what_happens_when_the_motion_turns(bench, name):
    """Friction flips with the direction, asymmetries do not, efforts of position do not notice."""
    effect = bench(name)
    for v in (1e-4, 0.003, 0.2, 1.0):
        seen = {"time": 2.0, "position": 0.13, "acceleration": 0.4} | CARRIED
        there, back = effect.law(velocity=v, **seen), effect.law(velocity=-v, **seen)
        wanted = -there if name in ODD_IN_VELOCITY else there
        assert back == pytest.approx(wanted, rel=1e-12, abs=0)
        if name in BLIND_TO_VELOCITY:
            assert there == effect.law(velocity=0.0, **seen)


@pytest.mark.parametrize("name", ODD_ALTOGETHER)
def test_effects_with_memory_have_no_side(bench, name):
    """The mirrored motion from the mirrored state gives the mirrored effort and rates."""
    effect, rng = bench(name), np.random.default_rng(5)
    for _ in range(5):
        z = rng.uniform(-0.9, 0.9, len(effect.effect.states))
        seen = {name: rng.normal() for name in ("position", "velocity", "acceleration", "rate")}
        law, rates = effect(z, **seen)
        mirrored, back = effect(-z, **{name: -value for name, value in seen.items()})
        assert mirrored == pytest.approx(-law, rel=1e-9)
        assert back == pytest.approx(-rates, rel=1e-9)


def test_every_effort_and_flow_has_a_symmetry_test():
    efforts = {effect.id for effect in EFFECTS if effect.in_equations}
    assert efforts == {
        *ODD_IN_VELOCITY,
        *EVEN_IN_VELOCITY,
        *BLIND_TO_VELOCITY,
        *ODD_ALTOGETHER,
        *OF_THE_SPEED,
    }


def closed_motion(seed: int, period: float = 2.0, amplitude: float = 0.15):
    """A smooth closed path of three harmonics: position, velocity, acceleration."""
    rng = np.random.default_rng(seed)
    weights, phases = rng.normal(size=3) / [1, 2, 3], rng.uniform(0, 2 * np.pi, 3)
    omega = 2 * np.pi * np.arange(1, 4) / period

    def motion(t: float) -> dict[str, float]:
        angle = omega * t + phases
        return {
            "position": amplitude * float(weights @ np.sin(angle)),
            "velocity": amplitude * float(weights @ (omega * np.cos(angle))),
            "acceleration": amplitude * float(weights @ (-(omega**2) * np.sin(angle))),
        }

    return motion


def work(bench, motion, period: float = 2.0, cycles: int = 1) -> tuple[float, float]:
    """Work done against the effect over the last of some cycles, and the integral of |F v| in it."""
    n = 801
    time = np.linspace(0, cycles * period, (n - 1) * cycles + 1)
    law, _ = bench.run(motion, time)
    last = slice(-n, None)
    power = (law * [motion(t)["velocity"] for t in time])[last]
    return float(np.trapezoid(power, time[last])), float(np.trapezoid(np.abs(power), time[last]))


CONSERVATIVE = (
    "offset",
    "cogging",
    *("linear_stiffness", "preloaded_spring"),
    "cubic_stiffness",
    "free_play",
    "gravity",
    "end_stop",
    "wheel_lift_off",
    "added_inertia",
    "varying_inertia",
    "cyclic_inertia",
    "detent",
)
DISSIPATIVE = ("viscous", "coulomb", "stribeck", "quadratic_drag", "eddy_brake", *LOADED)


@pytest.mark.parametrize("name", CONSERVATIVE)
@pytest.mark.parametrize("seed", range(3))
def test_conservative_effects_give_back_what_they_took(bench, name, seed):
    effect = bench(name, **({"offset": 2.0} if name == "offset" else {}))
    if name == "gravity":
        effect = bench(name, G_s=2.0, G_c=-1.0)
    if name in ("end_stop", "wheel_lift_off"):
        effect = bench(name, d=0.02)
    net, gross = work(effect, closed_motion(seed))
    assert gross > 1e-4
    assert abs(net) < 1e-4 * gross


@pytest.mark.parametrize("name", DISSIPATIVE)
def test_friction_takes_power_at_every_instant(bench, name):
    effect = bench(name)
    for v in np.concatenate([-np.logspace(-6, 1, 30), np.logspace(-6, 1, 30)]):
        power = effect.law(velocity=v, position=0.1, time=1.0, **CARRIED) * v
        assert power >= 0
        assert power > 0 or abs(v) > 1, "no friction at slow motion"


@pytest.mark.parametrize("name", REMEMBERING)
@pytest.mark.parametrize("seed", range(3))
def test_effects_with_memory_take_energy_over_a_cycle(bench, name, seed):
    shape = {"frequency": 1.0, "zeta": 0.5} if name == "flexible_mode" else {}
    net, gross = work(bench(name, **shape), closed_motion(seed), cycles=3)
    assert gross > 1e-4
    assert net > 1e-3 * gross


def test_position_friction_and_drift_take_energy_where_their_level_is_positive(bench):
    slope, drift = bench("position_friction", slope=5.0), bench("friction_drift", r_c=0.5, r_v=0.2)
    for v in (-0.3, 0.3):
        assert slope.law(position=0.1, velocity=v) * v > 0
        assert slope.law(position=-0.1, velocity=v) * v < 0
        assert drift.law(time=10.0, velocity=v) * v > drift.law(time=1.0, velocity=v) * v > 0
        assert drift.law(time=0.0, velocity=v) == 0


def test_cyclic_friction_repeats_over_a_turn(bench):
    rub = bench("cyclic_friction", f_c=0.3, f_s=0.1, n=1.0)
    once, again, half = (rub.law(position=q, velocity=1.0) for q in (0.4, 0.4 + 2 * np.pi, 0.4 + np.pi))
    assert once == pytest.approx(again) == pytest.approx(-half)


def test_friction_beyond_a_gap_acts_on_both_sides_of_it_alone(bench):
    rub = bench("friction_beyond_gap", f_c=5.0, g=0.1, width=1e-3)
    for v in (-0.3, 0.3):
        inside, above, below = (rub.law(position=q, velocity=v) for q in (0.05, 0.15, -0.15))
        assert above == below == pytest.approx(5.0 * np.sign(v))
        assert inside == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize("name", ["varying_force_factor", "torque_ripple"])
def test_what_a_drive_loses_is_a_share_of_it(bench, name):
    drive = bench(name)
    lost = drive.law(position=0.13, drive=2.0)
    assert drive.law(position=0.13, drive=-6.0) == pytest.approx(-3 * lost)
    assert drive.law(position=0.13, drive=0.0, load=5.0) == 0.0


def test_a_torque_ripple_repeats_over_its_pitch(bench):
    ripple = bench("torque_ripple", b_s=0.1, b_c=0.2, pitch=0.04)
    once, again, half = (ripple.law(position=q, drive=3.0) for q in (0.003, 0.043, 0.023))
    assert once == pytest.approx(again) == pytest.approx(-half)


def test_the_work_on_a_load_behind_a_play_is_stored_or_lost_in_the_contact(bench):
    """Work on the load = its kinetic energy + energy of the spring + what the damper took (>= 0)."""
    p = {"m_l": 2.0, "g": 0.01, "frequency": 8.0, "zeta": 0.2, "width": 1e-5}
    effect, motion = bench("backlash", **p), closed_motion(1)
    time = np.linspace(0, 2.0, 8001)
    law, z = effect.run(motion, time)
    v = np.array([motion(t)["velocity"] for t in time])
    given = np.concatenate([[0.0], np.cumsum(0.5 * (law * v)[1:] + 0.5 * (law * v)[:-1]) * np.diff(time)])
    v_load, stiffness = v + z[:, 1], p["m_l"] * (2 * np.pi * p["frequency"]) ** 2
    kinetic = 0.5 * p["m_l"] * (v_load**2 - v_load[0] ** 2)
    spring = 0.5 * stiffness * np.maximum(np.abs(z[:, 0]) - p["g"], 0.0) ** 2
    lost = given - kinetic - spring
    assert spring.max() > 0.1 * kinetic.max(), "the contact must have closed"
    assert np.diff(lost).min() > -1e-4 * np.abs(given).max()
    assert lost[-1] > 1e-3 * np.abs(given).max()


@pytest.mark.parametrize("name", ["flexible_mode", "backlash"])
def test_the_effort_of_a_hidden_load_is_what_accelerates_it(bench, name):
    """F = m_l (a + w'): Newton's law for the load."""
    effect, rng = bench(name), np.random.default_rng(6)
    for _ in range(10):
        z, a = rng.normal(size=2) * [0.02, 0.3], rng.normal()
        law, rates = effect(z, acceleration=a)
        assert law == pytest.approx(effect.p["m_l"] * (a + rates[1]), rel=1e-9, abs=1e-9)
        assert rates[0] == z[1]


def test_a_stiff_mode_is_an_added_inertia(bench):
    stiff = bench("flexible_mode", m_l=3.0, frequency=100.0, zeta=0.7)
    rigid = bench("added_inertia", m_a=3.0)
    motion, time = closed_motion(2), np.linspace(0, 1, 401)
    law, _ = stiff.run(motion, time)
    wanted = np.array([rigid.law(**motion(t)) for t in time])
    assert np.abs(law - wanted)[100:].max() < 0.02 * np.abs(wanted).max()


def test_backlash_leaves_the_load_alone_inside_the_play(bench):
    loose = bench("backlash", g=0.01, width=1e-6)
    assert abs(loose.law(z=[0.005, 0.1], acceleration=2.0)) < 1e-3 * bench("flexible_mode").law(
        z=[-0.005, 0.0]
    )
    law, rates = loose(z=[0.0, 0.0], acceleration=2.0)
    assert law == pytest.approx(0.0, abs=1e-9)
    assert rates[1] == pytest.approx(-2.0)


def test_springs_with_gaps_and_stops_are_what_their_equations_say(bench):
    """Away from the rounded edges, to the width's own size."""
    play = bench("free_play", k=50.0, g=0.02)
    assert play.law(position=0.015) == pytest.approx(-50 * 0.015, abs=0.01)
    assert play.law(position=0.30) == pytest.approx(-50 * 0.02, abs=0.01)
    upper, lower = bench("end_stop", k=50.0, d=0.1), bench("end_stop", k=50.0, d=0.1, side=-1.0)
    assert upper.law(position=0.3) == pytest.approx(50 * 0.2, rel=1e-4)
    assert upper.law(position=-0.3) == pytest.approx(0.0, abs=1e-6)
    assert lower.law(position=-0.3) == pytest.approx(-50 * 0.2, rel=1e-4)
    assert lower.law(position=0.3) == pytest.approx(0.0, abs=1e-6)
    damped = bench("end_stop", k=50.0, d=0.1, tau=0.02, side=-1.0)
    assert damped.law(position=-0.3, velocity=-2.0) == pytest.approx(-50 * (0.2 + 0.02 * 2.0), rel=1e-4)
    assert damped.law(position=-0.3, velocity=2.0) == pytest.approx(-50 * (0.2 - 0.02 * 2.0), rel=1e-4)
    assert damped.law(position=0.3, velocity=-2.0) == pytest.approx(0.0, abs=1e-6)
    tyre = bench("wheel_lift_off", k=50.0, d=0.1)
    for q in (-0.5, -0.2, 0.0, 0.3):
        carried = 50 * (0.1 + q) + tyre.law(position=q)
        assert carried == pytest.approx(max(50 * (0.1 + q), 0.0), abs=1e-3), "a tyre never pulls"


def test_a_detent_holds_most_at_its_width_and_lets_go_beyond(bench):
    catch = bench("detent", F_d=5.0, q_0=0.2, w=0.01)
    assert catch.law(position=0.2) == 0.0
    assert catch.law(position=0.21) == pytest.approx(5.0)
    assert catch.law(position=0.19) == pytest.approx(-5.0)
    assert max(abs(catch.law(position=q)) for q in np.linspace(0, 0.4, 4001)) == pytest.approx(5.0)
    assert abs(catch.law(position=0.26)) < 1e-5


def test_stribeck_friction_falls_with_speed(bench):
    effect = bench("stribeck", df_s=4.0, v_s=0.1)
    slow, knee, fast = (effect.law(velocity=v) for v in (0.01, 0.1, 1.0))
    assert slow == pytest.approx(4.0, rel=0.02)
    assert knee == pytest.approx(4.0 * np.exp(-1), rel=1e-6)
    assert fast < 1e-6


def test_asymmetric_damper_is_the_difference_of_two_dampers_above_its_knee(bench):
    effect = bench("asymmetric_damper", dc=6.0, v_k=1e-3)
    rebound, compression = effect.law(velocity=-1.0), effect.law(velocity=1.0)
    assert rebound == compression == pytest.approx(-3.0, rel=2e-3)
    # the force beside a symmetric damper c v: (c + dc/2) |v| in rebound, (c - dc/2) |v| in compression
    slow = bench("asymmetric_damper", dc=6.0, v_k=0.5)
    assert abs(slow.law(velocity=0.01)) < 0.02 * 3.0 * 0.01


TWINS = {  # rig law -> effect and its parameters from the rig's
    "viscous": ("viscous", {"f_v": "f_v"}),
    "coulomb": ("coulomb", {"f_c": "f_c"}),
    "offset": ("offset", {"offset": "offset"}),
    "asymmetric_viscous": ("asymmetric_viscous", {"df_v": "difference"}),
    "asymmetric_coulomb": ("asymmetric_coulomb", {"df_c": "difference"}),
    "stribeck": ("stribeck", {"df_s": "amplitude", "v_s": "velocity"}),
    "quadratic_drag": ("quadratic_drag", {"c_d": "c"}),
    "cubic_stiffness": ("cubic_stiffness", {"k_3": "k_3", "q_0": "q_0"}),
    "position_friction": ("position_friction", {"slope": "slope"}),
    "friction_drift": ("friction_drift", {"r_c": "rate"}),
}


@pytest.mark.parametrize("name", TWINS)
def test_the_rigs_independent_law_is_the_same_physics(bench, name):
    """The truth of a rig is written by another hand: what is planted is what the library calls so."""
    id_, shared = TWINS[name]
    law, rng = law_named(name), np.random.default_rng(7)
    for _ in range(10):
        values = {parameter: rng.uniform(0.1, 2.0) for parameter, _ in law.parameters}
        if name == "position_friction":
            values["q_0"] = 0.0
        known = {p.name: 0.0 for p in effect_named(id_).parameters}
        effect = bench(id_, **known | {ours: values[theirs] for ours, theirs in shared.items()})
        t, q, v = rng.uniform(0, 5), rng.normal(), rng.choice([-1, 1]) * rng.uniform(0.1, 1)
        row = np.array([values[parameter] for parameter, _ in law.parameters])
        theirs = law.function(t, q, v, np.sign(v), np.zeros(0), row, np.zeros(0))
        assert effect.law(time=t, position=q, velocity=v) == pytest.approx(theirs, rel=1e-9)
