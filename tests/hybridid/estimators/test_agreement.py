"""Every method and every layout of horizons and intervals reaches the optimum of the same problem."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import least_squares

from hybridid.declarations import State
from hybridid.estimators import FitSettings, fit
from hybridid.estimators.problem import build_problem
from hybridid.model import compose
from hybridid.plants.emps import EMPS

LAYOUTS = {
    "single shooting": {"interval": 1000},
    "multiple shooting": {"interval": 40},
    "odd intervals": {"interval": 77},
    "N-step prediction": {"horizon": 50, "interval": 50},
    "multiple shooting in horizons": {"horizon": 150, "interval": 40},
}


@pytest.fixture(scope="module")
def reference(symmetric, noisy):
    """The fast method's optimum for each horizon."""
    horizons = {layout.get("horizon") for layout in LAYOUTS.values()}
    return {h: fit(symmetric, [noisy], FitSettings(horizon=h, substeps=2)) for h in horizons}


@pytest.mark.parametrize("hessian", ["exact", "gauss_newton"])
@pytest.mark.parametrize("layout", LAYOUTS)
def test_multiple_shooting_and_gauss_newton_agree(symmetric, noisy, reference, values_of, layout, hessian):
    expected = reference[LAYOUTS[layout].get("horizon")]
    settings = FitSettings(method="multiple_shooting", hessian=hessian, substeps=2, **LAYOUTS[layout])
    found = fit(symmetric, [noisy], settings)
    assert found.converged, found.status
    assert found.cost == pytest.approx(expected.cost, rel=1e-6)
    std = np.array([p.std for p in expected.parameters])
    assert np.all(np.abs(values_of(found) - values_of(expected)) < 0.01 * std)
    np.testing.assert_allclose([p.std for p in found.parameters], std, rtol=0.02)
    np.testing.assert_allclose(found.initial_states[:, 0], expected.initial_states[:, 0], atol=1e-8)
    np.testing.assert_allclose(found.initial_states[:, 1], expected.initial_states[:, 1], atol=1e-6)


def test_measured_initial_states_agree_too(symmetric, noisy, values_of):
    found = [
        fit(symmetric, [noisy], FitSettings(method=method, interval=60, initial_state="measured"))
        for method in ("gauss_newton", "multiple_shooting")
    ]
    np.testing.assert_allclose(found[0].initial_states, found[1].initial_states, rtol=1e-12, atol=1e-15)
    assert found[0].cost == pytest.approx(found[1].cost, rel=1e-6)
    np.testing.assert_allclose(values_of(found[0]), values_of(found[1]), rtol=1e-4)


def test_the_optimum_is_scipys(symmetric, noisy, free_run_fit, values_of):
    """Parameters and initial states against ``least_squares`` from another start."""
    best, names = _scipy(symmetric, noisy, None, free_run_fit.substeps)
    assert free_run_fit.cost == pytest.approx(best.cost, rel=1e-6)
    np.testing.assert_allclose(values_of(free_run_fit), best.x[: len(names)] * _scale(symmetric), rtol=1e-4)


@pytest.mark.parametrize("method", ["gauss_newton", "multiple_shooting"])
def test_bounds_of_states_hold_and_the_optimum_inside_them_is_found(noisy, method):
    """Horizons that want to begin faster than the bound allows, and friction that wants below zero."""

    class Slow(EMPS):
        states = (EMPS.states[0], State("v", "m/s", 0.1, -0.02, 0.02, observed_by="position", derivative=1))

    model = compose(Slow(), ["viscous", "coulomb", "offset"], {"carriage.epsilon": {"guess": 3e-3}})
    found = fit(model, [noisy], FitSettings(method=method, horizon=50, substeps=2))
    velocities = found.initial_states[:, 1]
    assert found.converged, found.status
    assert np.abs(velocities).max() <= 0.02
    assert (np.abs(velocities) > 0.0199).sum() >= 4, "the bound is active"
    best, _ = _scipy(model, noisy, 50, 2)
    assert found.cost == pytest.approx(best.cost, rel=1e-5)


def _scale(model) -> np.ndarray:
    return np.array([p.scale for p in model.free])


def _scipy(model, record, horizon, substeps):
    problem = build_problem(model, [record], horizon, substeps)
    n, count, scale = len(model.free), problem.windows.count, _scale(model)
    x_scale = np.array([s.scale for s in model.states])

    def residual(z):
        p = model.values()
        p[:n] = z[:n] * scale
        return problem.residuals(problem.shooter(z[n:].reshape(count, -1) * x_scale, p)).ravel()

    lower = np.append(
        np.array([p.lower for p in model.free]) / scale,
        np.tile([s.lower / s.scale for s in model.states], count),
    )
    upper = np.append(
        np.array([p.upper for p in model.free]) / scale,
        np.tile([s.upper / s.scale for s in model.states], count),
    )
    start = np.append(np.full(n, 0.7), (problem.measured_x0() / x_scale).ravel())
    start = np.clip(start, np.maximum(lower, -1e9) + 1e-6, np.minimum(upper, 1e9) - 1e-6)
    exact = dict.fromkeys(("xtol", "ftol", "gtol"), 1e-12)
    return least_squares(residual, start, bounds=(lower, upper), max_nfev=200, **exact), model.free
