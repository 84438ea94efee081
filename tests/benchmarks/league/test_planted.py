"""The rigs of the league hide what they say, and the oracle is told the same. All is simulated."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import casadi as ca
import numpy as np
import pytest

from benchmarks.league.bench import Drive, Sensor
from benchmarks.league.laws import OUTSIDE
from benchmarks.league.machines import CASES, LINK
from benchmarks.league.memory import STATES, bristle, relaxing
from benchmarks.league.planting import Hidden
from benchmarks.league.scenario import CATEGORIES, Scenario
from benchmarks.league.scenarios import all_scenarios
from hybridid.effects.effect import Local
from hybridid.effects.library import EFFECTS, effect_named

ALL = {s.key: s for s in all_scenarios()}
LIBRARY = {effect.id for effect in EFFECTS}


def test_scenarios_cover_every_category_and_plant():
    assert {s.category for s in ALL.values()} == set(CATEGORIES)
    assert {s.machine for s in ALL.values()} == set(CASES)
    assert len({s.seed for s in ALL.values()}) == len(ALL)
    for s in ALL.values():
        assert bool(s.hidden) == (s.category != "nothing"), s.key
        assert all(h.what in LIBRARY or s.category == "outside" for h in s.hidden), s.key
    # two that the library has come to know since the league was drawn up
    assert set(OUTSIDE) & LIBRARY == {"eddy_brake", "position_damping"}


@pytest.mark.parametrize("key", ALL)
def test_what_is_planted_has_its_twin_for_the_oracle(key):
    """The effect exists at that port, and knows every value that the truth states."""
    for one in ALL[key].hidden:
        port = CASES[ALL[key].machine].plant.port(one.port)
        assert one.effect.kind == port.kind
        assert set(one.truth) <= {p.name for p in one.effect.parameters} | {"q_0"}
        if not one.on_path:
            assert one.planted.what.law.name


@pytest.mark.parametrize("name", sorted(OUTSIDE))
def test_a_twin_computes_what_its_law_does(name):
    """Outside the library a law is written twice, for the rig and for the oracle: they must agree."""
    one = next(h for s in ALL.values() for h in s.hidden if h.what == name)
    effect, law = one.effect, one.law
    values = np.array([one.values[n] for n, _ in law.parameters])
    symbols = {p.name: ca.SX(one.values[p.name]) for p in effect.parameters}
    for q, v in ((0.1, 0.13), (0.09, -0.05), (-0.02, 0.4), (0.1, -0.7)):
        z, rates = np.full(law.states, 0.02), np.zeros(law.states)
        expected = law.function(4.01, q, v, np.sign(v), z, values, rates)
        at = Local(
            p=SimpleNamespace(**symbols),
            z=SimpleNamespace(**{s.name: ca.SX(0.02) for s in effect.states}),
            time=ca.SX(4.01), epsilon=1e-6, position=ca.SX(q), velocity=ca.SX(v),
        )  # fmt: skip
        assert float(ca.evalf(ca.SX(effect.law(at)))) == pytest.approx(expected, rel=1e-3, abs=1e-3)
        if law.states:
            (rate,) = effect.dynamics(at).values()
            assert float(ca.evalf(rate)) == pytest.approx(rates[0], rel=1e-6)


def test_a_drive_delays_and_lags_what_it_is_told():
    """A mass alone under a step of input: position and velocity are then known in closed form."""
    dt, delay, lag = LINK.dt, 0.0055, 0.02
    free = {"servo": LINK.own["servo"][:0], "link": LINK.own["link"]}
    step = replace(LINK, own=free, runs={"step": lambda t: np.ones_like(t)}, duration=0.2, dt=dt)
    plain, late, slow, seen = (
        made.record("step", dict.fromkeys(LINK.outputs, sensor), seed=0).outputs[:, 0]
        for made, sensor in (
            (step, Sensor(0.0)),
            (replace(step, drive=Drive(delay=delay)), Sensor(0.0)),
            (replace(step, drive=Drive(lag=lag)), Sensor(0.0)),
            (step, Sensor(0.0, lag=lag)),
        )
    )
    time = dt * np.arange(len(plain))
    shifted = np.interp(time[5:] - delay, time, plain)
    assert late[5:] == pytest.approx(shifted, rel=0.01, abs=5e-4 * plain[-1])
    # of a linear machine at rest, a lag may stand before it or behind it
    assert slow == pytest.approx(seen, rel=0.01, abs=2e-3 * plain[-1])
    assert abs(slow - plain).max() > 0.1 * plain[-1]


def test_coloured_noise_is_as_loud_as_it_says():
    noise = Sensor(3.0, memory=0.9).disturbance(200_000, np.random.default_rng(0))
    assert noise.std() == pytest.approx(3.0, rel=0.02)
    assert np.corrcoef(noise[1:], noise[:-1])[0, 1] == pytest.approx(0.9, abs=0.01)


def test_states_along_a_motion_are_those_of_the_effects():
    """Against a fine Euler integration of the library's own dynamics."""
    dt, fine = 2e-3, 200
    time = dt * np.arange(800)
    v, a = 0.1 * np.sin(5 * time), 0.5 * np.cos(5 * time)
    for name, compute in STATES.items():
        effect = effect_named(name)
        port = CASES["carriage"].plant.port("carriage")
        p = {q.name: q.guess * q.scale_at(port) for q in effect.parameters}
        z = ca.SX.sym("z", len(effect.states))
        now = ca.SX.sym("now", 2)
        at = Local(
            p=SimpleNamespace(**{k: ca.SX(x) for k, x in p.items()}),
            z=SimpleNamespace(**{s.name: z[i] for i, s in enumerate(effect.states)}),
            time=ca.SX(0), velocity=now[0], acceleration=now[1],
        )  # fmt: skip
        rates = effect.dynamics(at)
        step = ca.Function(
            "step", [z, now], [z + dt / fine * ca.vertcat(*[rates[s.name] for s in effect.states])]
        )
        many = step.mapaccum(fine)
        x, expected = np.zeros(len(effect.states)), []
        for k in range(len(time)):
            expected.append(x)
            inside = time[k] + dt / fine * (np.arange(fine) + 0.5)
            moved = np.vstack([0.1 * np.sin(5 * inside), 0.5 * np.cos(5 * inside)])
            x = many(x, moved).full()[:, -1]
        # the first state alone: of a load that knocks, velocities jump at instants that differ a little
        made, reference = compute(v, a, dt, p)[:, 0], np.array(expected)[:, 0]
        assert np.sqrt(np.mean((made - reference) ** 2)) < 0.05 * np.sqrt(np.mean(reference**2)), name


def test_a_bristle_saturates_and_a_branch_relaxes():
    v = np.full(2000, 0.05)
    assert bristle(v, 1e-3, 2e-3, 0.0, 1.0)[-1, 0] == pytest.approx(1.0)
    assert relaxing(v, 1e-3, 0.1)[-1, 0] == pytest.approx(0.005, rel=1e-6)


def test_an_unknown_category_is_refused():
    with pytest.raises(ValueError, match="allowed: clean"):
        Scenario("carriage", "easy", (), "none", 0.0)


def test_every_effect_of_the_library_that_a_rig_can_hide_is_hidden():
    hidden = {h.what for s in ALL.values() for h in s.hidden if h.what in LIBRARY}
    # what is one with the declared terms or the plant's own, or has no place in these rigs
    left = {effect.id for effect in EFFECTS} - hidden
    assert left == {
        "periodic_disturbance",
        "free_play",
        "gravity",
        "second_maxwell",  # only beside another one
        "third_maxwell",
        "added_inertia",
        "preloaded_spring",  # one with the offset that is declared
        "sensor_scale",
        "sensor_offset",
        "sensor_nonlinearity",
        "input_record_lag",  # a fault of the recording, not of the machine
        "sensor_periodic_error",
        "input_nonlinearity",
        "input_rate_limit",
        "side_capacity",
        "overflow_into",
        "natural_convection",
        "thermal_radiation",
        "falling_supply",
        "cyclic_inertia",
        "centrifugal_brake",
        "detent",
        "back_emf_limit",
        "varying_force_factor",
        "torque_ripple",
        # in the drawn league, or there under the names of their laws (heating, blow_off)
        "load_friction",
        "load_stribeck",
        "two_sided_load_friction",
        "input_scaled_friction",
        "friction_behind_play",
        "friction_beyond_gap",
        "cyclic_friction",
        "warming_friction",
        "blow_off_valve",
        "varying_inertia",
        # in the rebuilt rows
        "hardening_hysteresis",
        "overflow",
        "orifice_leak",
        "steady_leak",
        "linear_leak",
        "periodic_flow",
    }
    assert Hidden("dahl", "carriage", {"amplitude": 5.0, "stiffness": 2500.0}).truth["s"] == pytest.approx(
        2e-3
    )


@pytest.mark.parametrize("machine", CASES)
def test_every_machine_says_the_truth_of_all_that_is_fitted(machine):
    assert set(CASES[machine].truth) == {p.name for p in CASES[machine].model().free}
