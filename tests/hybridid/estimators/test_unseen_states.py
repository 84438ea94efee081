"""States that no output shows: where they come from, and how a fit starts without a regression."""

from __future__ import annotations

import numpy as np
import pytest

from hybridid.estimators.carried import run_on
from hybridid.estimators.problem import build_problem
from hybridid.estimators.short_horizons import SHORT, short_horizon_problem, short_horizon_start
from hybridid.estimators.start import x0_candidates
from hybridid.model import compose
from hybridid.plants.emps import EMPS
from hybridid.plants.esea import ESEA
from hybridid.records.record import Channel, Record
from hybridid.simulation import initial, simulate
from hybridid.simulation.unobserved import filled_states, free_run_states

F_V = "motor.viscous.f_v"


@pytest.fixture(scope="module")
def joint():
    """A noiseless eSEA with linear friction of 0.004 N·m·s/rad, and its states."""
    n, model = 1201, compose(ESEA(), ["viscous"])
    time = np.arange(n) * 0.002
    torque = 0.2 * np.sin(2 * np.pi * (1 + time) * time)
    channels = (Channel("torque", "N·m", "zoh"),), (Channel("link_velocity", "rad/s"),)
    blank = Record("joint", time, torque[:, None], np.zeros((n, 1)), *channels)
    run = simulate(model, {F_V: 0.004}, blank, np.zeros(4), 8)
    return Record("joint", time, torque[:, None], run.outputs, *channels, simulated=True), run.states


def test_a_free_run_finds_the_twist_that_no_output_shows(joint):
    record, states = joint
    model = compose(ESEA(), ["viscous"])
    run = free_run_states(model, model.values({F_V: 0.004}), record)
    twist = states[:, 2] - states[:, 3]
    assert np.std(run[:, 2] - run[:, 3] - twist) < 0.01 * np.std(twist)


def test_what_an_output_shows_stays_as_measured(joint):
    record, _ = joint
    model = compose(ESEA(), ["viscous"])
    wrong = model.values({F_V: 0.02})
    filled, run = filled_states(model, wrong, record), free_run_states(model, wrong, record)
    assert np.std(filled[:, 1] - record.outputs[:, 0]) < 0.02 * record.outputs.std()
    assert np.std(run[:, 1] - record.outputs[:, 0]) > 0.2 * record.outputs.std()
    np.testing.assert_array_equal(filled[:, [0, 2, 3]], run[:, [0, 2, 3]])


def test_a_run_that_leaves_the_numbers_counts_as_zero(joint):
    record, _ = joint
    model = compose(ESEA(), ["viscous"], {"K_e": {"fixed": -30.0}})
    states = free_run_states(model, model.values(), record)
    assert np.isfinite(states).all()
    assert (states[-1] == 0).all()


def test_a_plant_s_states_are_estimated_for_each_horizon_and_an_effect_s_handed_on(joint):
    """As docs/write-your-own.md says; with ``initial_state: measured`` a hidden state begins at zero."""
    record, _ = joint
    model = compose(ESEA(), ["viscous", "maxwell"])
    of_plant = np.arange(len(model.states)) < len(model.plant.states)
    hidden = ~np.array(initial.observed(model))
    assert (hidden & of_plant).any()
    assert (hidden & ~of_plant).any()
    problem = build_problem(model, [record], 200, 4)
    np.testing.assert_array_equal(problem.carried, ~of_plant)
    np.testing.assert_array_equal(problem.moving, np.tile(of_plant, (problem.windows.count, 1)))
    measured = build_problem(model, [record], 200, 4, estimate_x0=False)
    assert not measured.moving.any()
    assert not measured.measured_x0()[:, hidden].any()


def test_horizons_may_start_from_a_free_run(joint):
    record, states = joint
    model = compose(ESEA(), ["viscous"])
    problem = build_problem(model, [record], 200, 4)
    starts = np.array([start for _, start, _ in problem.windows.origin])
    candidates = x0_candidates(problem, model.values({F_V: 0.004}))
    twists = [x0[:, 2] - x0[:, 3] - (states[starts, 2] - states[starts, 3]) for x0 in candidates]
    spread = np.std(states[:, 2] - states[:, 3])
    assert min(np.abs(twist).max() for twist in twists) < 0.05 * spread


def test_short_horizons_lead_from_a_poor_guess_to_the_truth(joint):
    record, _ = joint
    model = compose(ESEA(), ["viscous"], {F_V: {"guess": 0.1}})
    short = short_horizon_problem(build_problem(model, [record], None, 4))
    assert short is not None
    assert short.windows.length == SHORT
    p = short_horizon_start(short, model.values(), 1.0)
    assert p[[q.name for q in model.parameters].index(F_V)] == pytest.approx(0.004, rel=0.02)


def test_they_are_left_out_where_they_do_not_help(joint, carriage):
    record, _ = joint
    model = compose(ESEA(), ["viscous"])
    assert short_horizon_problem(build_problem(model, [record], 2 * SHORT, 4)) is None
    seen = compose(EMPS(), ["viscous"])
    assert short_horizon_problem(build_problem(seen, [carriage.record()], None, 1)) is None


def test_where_the_machine_stands_runs_on_from_horizon_to_horizon(joint):
    """No output feels the angle of the whole: horizons begun anywhere come onto one way, the twist stays."""
    record, states = joint
    model = compose(ESEA(), ["viscous"])
    problem, p = build_problem(model, [record], 150, 8), model.values({F_V: 0.004})
    begins = [start for _, start, _ in problem.windows.origin]
    astray = np.array(states[begins])
    astray[1:, 2:] += np.random.default_rng(0).normal(size=(len(astray) - 1, 1))
    found = run_on(problem, p, astray)
    np.testing.assert_allclose(found, states[begins], atol=1e-4)
    assert np.abs(astray[1:] - states[begins][1:]).max() > 0.5
    np.testing.assert_allclose(
        problem.shooter(found, p).outputs, problem.shooter(astray, p).outputs, atol=1e-9
    )


def test_a_record_is_smoothed_once_for_all_models(monkeypatch, carriage, make_model):
    record, calls = carriage.record(200), []
    found = initial.smoothed_derivative
    monkeypatch.setattr(initial, "smoothed_derivative", lambda *given: calls.append(given) or found(*given))
    one, other, sprung = (make_model(effects) for effects in (("viscous",), ("coulomb",), ("maxwell",)))
    measured = [build_problem(model, [record], 50, 1).measured_x0() for model in (one, other, sprung)]
    assert [derivative for *_, derivative, _ in calls] == [0, 1], "position and velocity, once each"
    np.testing.assert_array_equal(measured[0], measured[1])
    np.testing.assert_array_equal(measured[2][:, :2], measured[0])
    build_problem(one, [carriage.record(200)], 50, 1).measured_x0()
    assert len(calls) == 4, "another record"
