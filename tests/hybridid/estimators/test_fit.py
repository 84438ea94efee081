"""A fit returns the simulated truth, says how it went, and refuses what cannot be fitted in one line."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from hybridid.estimators import FitSettings, fit
from hybridid.simulation import simulate
from hybridid.simulation.chosen import integrator_for


@pytest.mark.parametrize("horizon", [None, 100, 37])
def test_the_truth_returns_from_a_record_without_noise(carriage, symmetric, horizon):
    estimate = fit(symmetric, [carriage.record()], FitSettings(horizon=horizon))
    assert estimate.converged
    assert all("smoothing sign(v)" in note for note in estimate.warnings), "no noise: nothing else is left"
    found = {p.name: p.value for p in estimate.parameters}
    assert found == pytest.approx(carriage.truth, rel=2e-4)
    assert estimate.cost < 1e-6


def test_several_records_are_fitted_together(carriage, carriage_like, symmetric):
    """Two carriages of different mass: the fit lies between them, each with its own initial state."""
    records = [carriage.record(), carriage_like(M=105.0).record(400, name="heavy")]
    estimate = fit(symmetric, records, FitSettings(horizon=100))
    assert {row[0] for row in estimate.origin} == {0, 1}
    assert len(estimate.initial_states) == len(estimate.origin)
    assert 95.5 < estimate.values["M"] < 104.5
    assert estimate.cost > 100 * fit(symmetric, records[:1], FitSettings(horizon=100)).cost


def test_an_exact_fit_is_an_end_and_not_a_stall(carriage, symmetric):
    """Data made by the estimator's own integrator leave nothing to gain."""
    made = carriage.record()
    own = replace(
        made, outputs=simulate(symmetric, carriage.truth, made, np.zeros(2), 2).outputs, warnings=()
    )
    for horizon in (None, 100):
        estimate = fit(symmetric, [own], FitSettings(substeps=2, horizon=horizon))
        assert estimate.converged, estimate.status
        assert estimate.values["M"] == pytest.approx(95.0, rel=1e-7)


def test_measured_initial_states_are_kept(carriage, symmetric):
    made = carriage.record()
    estimate = fit(symmetric, [made], FitSettings(horizon=150, initial_state="measured"))
    starts = [start for _, start, _ in estimate.origin]
    np.testing.assert_allclose(estimate.initial_states[:, 0], made.outputs[starts, 0], atol=2e-4)
    free = fit(symmetric, [made], FitSettings(horizon=150))
    assert estimate.cost > 10 * free.cost, "smoothed velocities are not the true ones"


def test_fixed_parameters_stay(carriage, make_model, noisy):
    model = make_model(adjust={"carriage.viscous.f_v": {"fixed": 180.0}})
    estimate = fit(model, [noisy])
    assert [p.name for p in estimate.parameters] == ["M", "carriage.coulomb.f_c", "carriage.offset.offset"]
    assert estimate.known["carriage.viscous.f_v"] == 180.0
    assert estimate.values["carriage.viscous.f_v"] == 180.0
    assert estimate.values["carriage.coulomb.f_c"] > 20.6, "Coulomb friction makes up for it"
    assert estimate.correlation.shape == (3, 3)


def test_a_fit_cut_short_says_so_first_and_loudly(symmetric, noisy):
    for method in ("gauss_newton", "multiple_shooting"):
        estimate = fit(symmetric, [noisy], FitSettings(method=method, max_iterations=1))
        assert not estimate.converged
        assert estimate.warnings[0].startswith("NOT CONVERGED")
        assert "iteration" in estimate.status


def test_progress_is_reported_with_a_falling_cost(symmetric, noisy):
    for method in ("gauss_newton", "multiple_shooting"):
        reports = []
        estimate = fit(symmetric, [noisy], FitSettings(method=method, continuation=(1.0,)), reports.append)
        assert len(reports) >= 3
        assert reports[-1].cost == pytest.approx(estimate.cost, rel=1e-3)
        assert reports[-1].cost < reports[0].cost


def test_iterations_count_every_descent(symmetric, noisy):
    """Coarser smoothing and second looks at trapped horizons are work too."""
    reports = []
    estimate = fit(symmetric, [noisy], FitSettings(horizon=100), reports.append)
    assert estimate.iterations >= len(reports) > 3


def test_a_model_that_diverges_from_every_start_is_one_line(make_model, noisy):
    model = make_model(
        ("viscous", "cubic_stiffness"),
        {"carriage.cubic_stiffness.k_3": {"fixed": -1e12}, "M": {"upper": 100}},
    )
    with pytest.raises(ValueError, match="diverges from every start on carriage") as caught:
        fit(model, [noisy], FitSettings(substeps=1))
    assert "\n" not in str(caught.value)


def test_too_stiff_a_model_is_one_line(make_model, noisy):
    model = make_model(("viscous", "linear_stiffness"), {"carriage.linear_stiffness.k": {"fixed": 1e13}})
    with pytest.raises(ValueError, match="too stiff for RK4") as caught:
        fit(model, [noisy], FitSettings(integrator="rk4"))
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(("k", "chosen"), [(1.0, "rk4"), (1e13, "rodas3")])
def test_left_open_the_implicit_integrator_is_taken_where_rk4_is_too_slow(make_model, noisy, k, chosen):
    model = make_model(("viscous", "linear_stiffness"), {"carriage.linear_stiffness.k": {"fixed": k}})
    assert integrator_for(model, model.values(), [noisy]) == chosen
    assert integrator_for(model, model.values(), [noisy], "rk4") == "rk4"
    with pytest.raises(ValueError, match="unknown integrator 'euler': known: rk4, rodas3"):
        integrator_for(model, model.values(), [noisy], "euler")


def test_the_estimate_says_which_integrator_was_taken(make_model, noisy):
    assert fit(make_model(), [noisy]).settings.integrator == "rk4"


def test_what_cannot_be_fitted_is_refused_in_one_line(carriage, make_model, symmetric):
    made = carriage.record(100)
    force = made.input_channels[0]
    two = replace(
        made, inputs=np.zeros((100, 2)), input_channels=(force, replace(force, name="other")), warnings=()
    )
    renamed = replace(made, input_channels=(replace(force, name="torque"),))
    in_volts = replace(made, input_channels=(replace(force, unit="V"),))
    known = make_model(adjust={name: {"fixed": value} for name, value in carriage.truth.items()})
    cases = [
        (symmetric, [two], "has the inputs force and other, plant emps needs force"),
        (symmetric, [renamed], "has the inputs torque, plant emps needs force"),
        (symmetric, [in_volts], "force is in V, plant emps needs N"),
        (symmetric, [], "no record"),
        (symmetric, [made, carriage.record(100, 0.01)], "differ in sampling time"),
        (known, [made], "nothing to estimate"),
    ]
    for model, records, words in cases:
        with pytest.raises(ValueError, match=words) as caught:
            fit(model, records)
        assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("wrong", "words"),
    [
        (
            {"method": "newton"},
            "estimator.method is 'newton': did you mean 'gauss_newton'\\? allowed: gauss_newton",
        ),
        ({"hessian": "bfgs"}, "estimator.hessian"),
        ({"start": "random"}, "estimator.start"),
        ({"initial_state": "zero"}, "estimator.initial_state"),
        ({"horizon": 1}, "estimator.horizon"),
        ({"interval": 1}, "estimator.interval"),
        ({"substeps": 0}, "estimator.substeps"),
        ({"starts": 0}, "estimator.starts"),
        ({"max_iterations": 0}, "estimator.max_iterations"),
        ({"continuation": (10.0, 3.0)}, "estimator.continuation"),
        ({"continuation": (0.5, 1.0)}, "estimator.continuation"),
        ({"continuation": ()}, "estimator.continuation"),
        ({"tolerance": 0.0}, "estimator.tolerance"),
        ({"tolerance": 10.0}, "estimator.tolerance"),
    ],
)
def test_wrong_settings_name_the_key(wrong, words):
    with pytest.raises(ValueError, match=words):
        FitSettings(**wrong)
