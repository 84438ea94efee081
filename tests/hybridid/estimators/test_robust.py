"""Huber's loss on the simulated carriage: outliers hardly move it, and its standard errors are true."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from hybridid.estimators import FitSettings, fit
from hybridid.estimators.problem import build_problem
from hybridid.estimators.robust import THRESHOLD, Clipped
from hybridid.estimators.start import best_initial_states
from hybridid.estimators.uncertainty import uncertainty

NOISE = 1e-5
SHARE, SIZE = 0.02, 50.0
"""Share of the samples that are spoiled, and by how many standard deviations of the noise."""
HUBER = FitSettings(loss="huber")


def spoiled(record, seed=0, size=SIZE * NOISE):
    """``record`` with outliers of ``size`` to either side, rather to one: a logger that loses a bit."""
    generator = np.random.default_rng(seed)
    hit = generator.random(record.n) < SHARE
    sign = np.where(generator.random(record.n) < 0.8, 1.0, -1.0)
    outputs = record.outputs + (hit * sign * size)[:, None]
    return replace(record, outputs=outputs, warnings=())


@pytest.mark.parametrize("horizon", [None, 100])
def test_outliers_move_it_by_less_than_its_standard_errors(symmetric, noisy, values_of, of_noise, horizon):
    clean = fit(symmetric, [noisy], FitSettings(horizon=horizon))
    bad = spoiled(noisy)
    huber, squared = (
        fit(symmetric, [bad], FitSettings(horizon=horizon, loss=w)) for w in ("huber", "squared")
    )
    moved = np.abs(values_of(huber) - values_of(clean))
    assert huber.converged
    assert (moved < 3 * of_noise(huber)).all()
    assert (of_noise(huber) < 2 * of_noise(clean)).all(), "and these are hardly wider than without outliers"
    far = np.abs(values_of(squared) - values_of(clean)) / of_noise(clean)
    assert far.max() > 6 * (moved / of_noise(clean)).max()
    assert (of_noise(squared) > 3 * of_noise(huber)).all()


def test_without_outliers_it_is_nearly_least_squares(symmetric, noisy, values_of, of_noise):
    squared, huber = (fit(symmetric, [noisy], FitSettings(loss=loss)) for loss in ("squared", "huber"))
    assert (np.abs(values_of(huber) - values_of(squared)) < of_noise(squared)).all()
    np.testing.assert_allclose(of_noise(huber), of_noise(squared), rtol=0.2)


def test_its_standard_errors_are_the_spread_of_its_estimates(carriage, symmetric, noise, values_of, of_noise):
    """Of 30 records with noise and outliers of their own."""
    found = []
    for seed in range(30):
        record = carriage.record(noise=noise(600, NOISE, seed=500 + seed))
        found.append(fit(symmetric, [spoiled(record, seed)], replace(HUBER, start="guess")))
    truth = np.array(list(carriage.truth.values()))
    errors = np.array([values_of(one) - truth for one in found])
    stated = np.array([of_noise(one) for one in found])
    assert 0.7 < np.sqrt(np.mean((errors / stated) ** 2)) < 1.35


def test_it_ends_where_its_gradient_is_zero(symmetric, noisy):
    """By the definition of the loss, not by its weights: no small step to either side lowers it."""
    record = spoiled(noisy)
    estimate = fit(symmetric, [record], HUBER)
    problem = build_problem(symmetric, [record], None, estimate.substeps)
    p, x0 = symmetric.values(estimate.values), estimate.initial_states
    residual = problem.residuals(problem.shooter(x0, p))
    k = THRESHOLD * np.median(np.abs(residual[problem.windows.used])) / 0.6745

    def cost(q):
        size = np.abs(problem.residuals(problem.shooter(x0, q)))
        return np.sum(np.where(size <= k, size**2 / 2, k * size - k**2 / 2))

    assert estimate.cost == pytest.approx(cost(p), rel=1e-9)
    for place, std in zip(problem.positions, [e.std for e in estimate.parameters], strict=True):
        step = np.zeros(len(p))
        step[place] = std / 100
        slope = (cost(p + step) - cost(p - step)) / 2
        bend = cost(p + step) - 2 * cost(p) + cost(p - step)
        assert abs(slope) < 3 * bend, "the optimum is within a few hundredths of a standard error"


def test_a_record_without_noise_has_no_outliers(symmetric, carriage, values_of):
    squared, huber = (fit(symmetric, [carriage.record()], FitSettings(loss=w)) for w in ("squared", "huber"))
    np.testing.assert_allclose(values_of(huber), values_of(squared), rtol=1e-4)


def test_weights_go_with_their_horizons(symmetric, noisy):
    problem = build_problem(symmetric, [noisy], 100, 2)
    weights = np.random.default_rng(0).uniform(0.1, 1.0, problem.windows.outputs.shape)
    weighted = replace(problem, weights=weights)
    p = symmetric.values()
    x0 = best_initial_states(problem, p, [problem.measured_x0()])
    part = weighted.on([1, 3])
    whole = weighted.residuals(problem.shooter(x0, p))
    np.testing.assert_allclose(part.residuals(part.shooter(x0[[1, 3]], p)), whole[[1, 3]], atol=1e-12)


def test_inner_states_and_masks_go_along(make_model, carriage_like, noise):
    """A fit over horizons that hand a bristle on, of a record with outliers and a masked part."""
    from hybridid.signals.masks import Mask

    model = make_model(("viscous", "dahl"), {"carriage.dahl.s": {"fixed": 1e-3}})
    record = carriage_like(offset=0.0).record(noise=noise(600, NOISE, seed=2))
    clean = fit(model, [record], FitSettings(horizon=150))
    bad = Mask(stretches=((1.0, 1.2),)).apply(spoiled(record))
    found = fit(model, [bad], FitSettings(horizon=150, loss="huber"))
    assert found.converged
    for one, other in zip(found.parameters, clean.parameters, strict=True):
        assert abs(one.value - other.value) < 3 * max(one.std, other.std)


def test_the_other_method_refuses_it():
    with pytest.raises(ValueError, match=r"estimator.loss=huber needs estimator.method=gauss_newton"):
        FitSettings(loss="huber", method="multiple_shooting")


def test_the_pseudo_residual_has_the_noise_s_variance(symmetric, noisy):
    record = spoiled(noisy)
    estimate = fit(symmetric, [record], HUBER)
    problem = build_problem(symmetric, [record], None, estimate.substeps)
    from hybridid.estimators.estimate import Solution

    at = Solution(symmetric.values(estimate.values), estimate.initial_states, 0.0, "", True, 0)
    clipped = Clipped.of(problem, at)
    rms = np.sqrt(np.mean(clipped.pseudo[problem.windows.used] ** 2)) * problem.scale[0]
    assert rms == pytest.approx(NOISE, rel=0.2)
    assert estimate.left[0].rmse == pytest.approx(rms, rel=1e-6)
    assert uncertainty(problem, at.p, at.x0, clipped.pseudo).std == pytest.approx(
        [p.std for p in estimate.parameters]
    )
