"""Where fits start: near the truth by regression, from several places on request, past sharp friction."""

from __future__ import annotations

from dataclasses import replace

import casadi as ca
import numpy as np
import pytest

from hybridid.effects.effect import Dimension, Effect, EffectParameter
from hybridid.estimators import FitSettings, fit
from hybridid.estimators.problem import build_problem
from hybridid.estimators.start import best_initial_states, regression_start, scattered
from hybridid.simulation import simulate

RIPPLE = Effect(
    id="ripple",
    kind="effort",
    title="a ripple over position",
    equation="F = A sin(2 pi q / L)",
    law=lambda at: at.p.A * ca.sin(2 * np.pi * at.position / at.p.L),
    parameters=(
        EffectParameter("A", Dimension(effort=1), "amplitude", guess=0.1, nests=True),
        EffectParameter("L", Dimension(position=1), "period", 0.25, 0.03, 2.0, starts=(0.05, 0.11)),
    ),
    source="this test",
    pattern="none",
)
STRIBECK = ("viscous", "coulomb", "offset", "stribeck")


def names(model) -> list[str]:
    return [p.name for p in model.parameters]


@pytest.mark.parametrize("std", [0.0, 2e-5])
def test_the_regression_starts_near_the_truth(carriage, symmetric, noise, std):
    made = carriage.record(3000, 0.001, noise(3000, std, seed=1))
    start = dict(zip(names(symmetric), regression_start(symmetric, [made]), strict=True))
    assert start["M"] == pytest.approx(95.0, rel=0.05)
    assert start["carriage.viscous.f_v"] == pytest.approx(203.0, rel=0.1)
    assert start["carriage.coulomb.f_c"] == pytest.approx(20.4, rel=0.1)
    assert start["carriage.offset.offset"] == pytest.approx(-3.2, abs=0.3)


def test_the_regression_keeps_to_bounds_and_known_values(carriage, make_model):
    model = make_model(adjust={"M": {"fixed": 80.0}, "carriage.coulomb.f_c": {"upper": 12.0}})
    start = dict(zip(names(model), regression_start(model, [carriage.record(3000, 0.001)]), strict=True))
    assert start["M"] == 80.0
    assert start["carriage.coulomb.f_c"] == pytest.approx(12.0)


def test_effects_with_states_keep_their_guess_in_the_regression(carriage, make_model):
    model = make_model(("viscous", "coulomb", "offset", "dahl"))
    start = dict(zip(names(model), regression_start(model, [carriage.record(3000, 0.001)]), strict=True))
    by_name = {p.name: p.guess for p in model.parameters}
    for name in ("carriage.dahl.f_c", "carriage.dahl.s"):
        assert start[name] == by_name[name]


def test_the_regression_keeps_the_guess_of_a_pitch(carriage_like, make_model):
    """The equation error has many minima over it; a fit stays in the valley where the guess lies."""
    truth = {"ripple": 15.0, "pitch": 0.02}
    record, name = carriage_like(**truth).record(800), "carriage.cogging.pitch"
    model = make_model(("viscous", "coulomb", "offset", "cogging"), {name: {"guess": 0.0201}})
    start = dict(zip([p.name for p in model.parameters], regression_start(model, [record]), strict=True))
    assert start[name] == 0.0201
    found = fit(model, [record], FitSettings(horizon=100)).values[name]
    assert found == pytest.approx(0.02, rel=2e-3)


def test_equations_that_cannot_be_evaluated_at_the_guess_leave_the_guess(carriage, make_model):
    """A root of the position, which is negative at times."""
    root = replace(RIPPLE, id="root", law=lambda at: at.p.A * ca.sqrt(at.position - 0.01) + 0 * at.p.L)
    model = make_model().plus(root)
    np.testing.assert_array_equal(regression_start(model, [carriage.record(500)]), model.values())


def test_further_starts_try_declared_shapes_and_stay_inside_the_bounds(make_model):
    model = make_model(STRIBECK, {"M": {"lower": 90.0, "upper": 100.0}})
    starts = scattered(model, model.values(), 12, seed=0)
    v_s = names(model).index("carriage.stribeck.v_s")
    assert len(starts) == 12
    np.testing.assert_array_equal(starts[0], model.values())
    declared = next(t.effect for t in model.terms if t.effect.id == "stribeck").parameters[1]
    shapes = declared.starts_at(model.plant.port("carriage"))
    assert [start[v_s] for start in starts[1 : 1 + len(shapes)]] == pytest.approx(shapes)
    masses = [start[0] for start in starts]
    assert 90.0 <= min(masses) < max(masses) <= 100.0
    again = scattered(model, model.values(), 12, seed=0)
    np.testing.assert_array_equal(starts, again)
    assert not np.array_equal(starts[-1], scattered(model, model.values(), 12, seed=1)[-1])


def test_further_starts_leave_known_parameters_alone(make_model):
    model = make_model(STRIBECK, {"carriage.stribeck.v_s": {"fixed": 0.02}, "M": {"fixed": 95.0}})
    for start in scattered(model, model.values(), 8, seed=0):
        assert start[names(model).index("carriage.stribeck.v_s")] == 0.02
        assert start[0] == 95.0


def test_the_best_of_several_starts_is_kept(symmetric, noisy, free_run_fit):
    poor = {"M": 600.0, "carriage.viscous.f_v": 1.0, "carriage.coulomb.f_c": 0.1}
    found = fit(symmetric, [noisy], FitSettings(starts=4, seed=3), start_values=poor)
    assert len(found.starts) == 4
    assert found.cost == pytest.approx(min(found.starts), rel=1e-6)
    assert found.cost == pytest.approx(free_run_fit.cost, rel=1e-6)


def test_initial_states_that_are_known_are_taken_where_they_fit_better(carriage, make_model):
    """A sensor that errs where each horizon begins: the record shows a wrong state there."""
    model, record = make_model(("viscous", "coulomb", "offset")), carriage.record()
    settings = FitSettings(horizon=100, max_iterations=1)
    states = build_problem(model, [record], 100, 2).measured_x0()
    begins = np.arange(record.n)[:, None] % 100 < 5
    spoilt = replace(record, outputs=record.outputs + 1e-2 * begins)
    without = fit(model, [spoilt], settings, start_values=carriage.truth)
    given = fit(model, [spoilt], settings, start_values=carriage.truth, start_states=states)
    assert given.cost < without.cost


def test_starts_that_end_higher_are_mentioned(carriage, make_model):
    """A ripple of 10 mm looked for at 25 mm: a valley of its own, which a declared start escapes."""
    model = make_model(("viscous", "coulomb", "offset")).plus(RIPPLE)
    made = carriage.record()
    truth = {**carriage.truth, "carriage.ripple.A": 8.0, "carriage.ripple.L": 0.01}
    run = simulate(model, truth, made, np.zeros(2), 4)
    made = replace(made, outputs=run.outputs, warnings=())
    single = fit(model, [made], FitSettings(horizon=100), start_values=carriage.truth)
    several = fit(model, [made], FitSettings(horizon=100, starts=3), start_values=carriage.truth)
    assert several.values["carriage.ripple.L"] == pytest.approx(0.01, rel=1e-3)
    assert single.cost > 100 * several.cost
    assert several.starts[0] == pytest.approx(single.starts[0], rel=1e-6)
    assert any("of 3 starts ended at a higher cost" in note for note in several.warnings)


def test_initial_states_are_chosen_horizon_by_horizon(carriage, symmetric):
    made = carriage.record(200)
    problem = build_problem(symmetric, [made], 50, 2)
    truth = carriage.states(600)[[0, 50, 100, 150]]
    first, second = truth.copy(), truth.copy()
    first[[0, 2], 1] += 0.05
    second[[1, 3], 1] += 0.05
    chosen = best_initial_states(problem, symmetric.values(carriage.truth), [first, second])
    np.testing.assert_array_equal(chosen, truth)


@pytest.mark.parametrize("start", ["regression", "guess"])
def test_true_dry_friction_is_found_and_does_not_move_as_the_smoothing_shrinks(
    carriage_like, make_model, start
):
    """The truth's sign is sharp (smoothed over 2 µm/s); the fit's error falls with its own epsilon."""
    dry = carriage_like(epsilon=2e-6)
    made = dry.record()
    errors, costs = [], []
    for epsilon in (1e-3, 3e-4, 1e-4):
        model = make_model(adjust={"carriage.epsilon": {"guess": epsilon}})
        found = fit(model, [made], FitSettings(start=start))
        assert found.converged
        assert found.known["carriage.epsilon"] == epsilon, "the continuation ends at the declared one"
        errors.append([abs(found.values[name] / value - 1) for name, value in dry.truth.items()])
        costs.append(found.cost)
    assert np.all(np.diff(errors, axis=0) < 0)
    assert np.all(np.diff(costs) < 0)
    assert max(errors[-1]) < 2e-3


def test_the_continuation_reaches_sharp_friction_from_far_away(carriage_like, make_model):
    made = carriage_like(epsilon=2e-6).record()
    model = make_model(adjust={"carriage.epsilon": {"guess": 1e-4}})
    far = {
        "M": 300.0,
        "carriage.viscous.f_v": 10.0,
        "carriage.coulomb.f_c": 1.0,
        "carriage.offset.offset": 5.0,
    }
    found = fit(model, [made], FitSettings(substeps=11), start_values=far)
    near = fit(
        model, [made], FitSettings(substeps=11, continuation=(1.0,)), start_values=carriage_like().truth
    )
    assert found.cost == pytest.approx(near.cost, rel=1e-5)
