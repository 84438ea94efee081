"""Standard errors: the classical ones for white noise, honest ones for noise that is not."""

from __future__ import annotations

import sys
from dataclasses import replace

import numpy as np
import pytest

from hybridid.declarations import Signal
from hybridid.estimators import FitSettings, fit
from hybridid.estimators.problem import build_problem
from hybridid.estimators.uncertainty import uncertainty
from hybridid.model import compose
from hybridid.plants.emps import EMPS
from hybridid.records.record import Channel
from hybridid.simulation import simulate, windows

DRAWS = 30


class TwoEncoders(EMPS):
    """The carriage seen by two encoders."""

    outputs = (*EMPS.outputs, Signal("again", "m"))

    def output(self, x, u, p):
        return {"position": x.q, "again": x.q}


@pytest.fixture(scope="module")
def inverse(carriage, symmetric) -> np.ndarray:
    """``(J' J)^-1`` of the free-running carriage in SI units, initial state included, by differences."""
    made, names = carriage.record(), list(carriage.truth)

    def outputs(z):
        return simulate(symmetric, dict(zip(names, z[:4], strict=True)), made, z[4:], 2).outputs[:, 0]

    z = np.array([*carriage.truth.values(), 0.0, 0.0])
    steps = np.diag([0.01, 0.01, 0.001, 0.001, 1e-5, 1e-5])
    jacobian = np.stack([(outputs(z + d) - outputs(z - d)) / (2 * d.sum()) for d in steps], axis=1)
    return np.linalg.inv(jacobian.T @ jacobian)[:4, :4]


def test_white_noise_gives_the_classical_covariance(free_run_fit, noisy, inverse, of_noise):
    variance = 2 * free_run_fit.cost * noisy.outputs.var() / (600 - 6)
    moved = np.array([p.smoothing for p in free_run_fit.parameters])
    total = variance * inverse + np.outer(moved, moved)
    size = np.sqrt(np.diag(total))
    np.testing.assert_allclose(of_noise(free_run_fit), np.sqrt(variance * np.diag(inverse)), rtol=0.05)
    np.testing.assert_allclose([p.std for p in free_run_fit.parameters], size, rtol=0.05)
    np.testing.assert_allclose(free_run_fit.correlation, total / np.outer(size, size), atol=0.05)


@pytest.fixture(scope="module")
def draws(carriage, symmetric, noise, of_noise):
    """``draws(settings, std, rho)``: errors and standard errors (draws, 4), and sums of squares (draws,)."""

    def make(settings, std, rho):
        errors, stated, squares = [], [], []
        for seed in range(DRAWS):
            made = carriage.record(noise=noise(600, std, rho, seed=100 + seed))
            found = fit(symmetric, [made], settings, start_values=carriage.truth)
            errors.append([p.value - carriage.truth[p.name] for p in found.parameters])
            stated.append(of_noise(found))
            squares.append(2 * found.cost * made.outputs.var())
        return np.array(errors), np.array(stated), np.array(squares)

    return make


def share(errors: np.ndarray, std: np.ndarray) -> float:
    """Share of the 95 % intervals that hold the truth, all parameters together."""
    return float(np.mean(np.abs(errors) <= 1.96 * std))


def test_white_noise_is_covered(draws):
    errors, std, _ = draws(FitSettings(horizon=100), 1e-4, 0.0)
    assert 0.88 <= share(errors, std) <= 1.0
    np.testing.assert_allclose(std.mean(axis=0), errors.std(axis=0), rtol=0.4)


def test_correlated_noise_is_covered_where_the_classical_interval_is_not(draws, inverse):
    errors, std, squares = draws(FitSettings(), 1e-4, 0.9)
    classical = np.sqrt(squares / (600 - 6))[:, None] * np.sqrt(np.diag(inverse))
    assert share(errors, classical) < 0.6
    assert 0.86 <= share(errors, std) <= 1.0


def test_correlated_noise_is_covered_over_short_horizons(draws):
    """Initial states take most of the slow noise out of the residual: that must not look like precision."""
    errors, std, _ = draws(FitSettings(horizon=60), 1e-4, 0.9)
    assert 0.86 <= share(errors, std) <= 1.0
    np.testing.assert_allclose(std.mean(axis=0), errors.std(axis=0), rtol=0.4)


@pytest.mark.parametrize("horizon", [None, 50])
def test_parts_of_the_horizons_together_are_the_whole(symmetric, noisy, free_run_fit, monkeypatch, horizon):
    problem = build_problem(symmetric, [noisy], horizon, 2, estimate_x0=horizon is None)
    p, x0 = symmetric.values(free_run_fit.values), problem.measured_x0()
    whole = uncertainty(problem, p, x0)
    for module in (windows, sys.modules[uncertainty.__module__]):
        monkeypatch.setattr(module, "PART", 128)
    parts = uncertainty(problem, p, x0)
    np.testing.assert_allclose(parts.covariance, whole.covariance, rtol=1e-8)
    np.testing.assert_allclose(parts.condition, whole.condition, rtol=1e-10)


def test_a_second_look_at_the_same_noise_adds_nothing(carriage, noise, make_model, of_noise):
    """Two encoders that share their noise know no more than one; with noise of their own they do."""
    one = carriage.record(noise=noise(600, 1e-5, 0.5, seed=1))
    single = fit(make_model(), [one])
    model = compose(TwoEncoders(), ["viscous", "coulomb", "offset"], {"carriage.epsilon": {"guess": 3e-3}})
    ratio = []
    for second in (one.outputs, carriage.record(noise=noise(600, 1e-5, 0.5, seed=2)).outputs):
        channels = (*one.output_channels, Channel("again", "m"))
        made = replace(one, outputs=np.hstack([one.outputs, second]), output_channels=channels)
        both = fit(model, [made])
        ratio.append(of_noise(both) / of_noise(single))
    np.testing.assert_allclose(ratio[0], 1.0, rtol=0.05)
    np.testing.assert_allclose(ratio[1], np.sqrt(0.5), rtol=0.2)


def test_noise_that_is_louder_in_fast_horizons_is_covered(carriage, symmetric, noise, of_noise):
    """As a model that lacks an effect leaves it. Noise alike everywhere would be stated 40 % too small."""
    n, length, name = 1200, 30, "carriage.viscous.f_v"
    fastest = np.abs(carriage.states(n)[:, 1]).reshape(-1, length).max(axis=1)
    level = np.repeat(np.where(fastest > np.quantile(fastest, 0.75), 2e-4, 1e-5), length)
    errors, stated = [], []
    for seed in range(DRAWS):
        made = carriage.record(n, noise=level * noise(n, 1.0, seed=500 + seed))
        found = fit(symmetric, [made], FitSettings(horizon=length, continuation=(1.0,)))
        errors.append(found.values[name] - carriage.truth[name])
        stated.append(of_noise(found)[[p.name for p in found.parameters].index(name)])
    assert np.mean(stated) > 0.7 * np.std(errors)
    assert share(np.array(errors), np.array(stated)) >= 0.8


def test_a_parameter_at_a_bound_still_has_an_error(make_model, noisy, free_run_fit):
    """Its interval says what the data say, not what the bound does."""
    found = fit(make_model(adjust={"carriage.coulomb.f_c": {"upper": 20.0}}), [noisy])
    at = {p.name: p for p in found.parameters}["carriage.coulomb.f_c"]
    assert at.at_bound
    assert 0 < at.std < np.inf


def test_more_data_halve_the_error(carriage, make_model, noise, of_noise):
    """Four records of the same motion: half the standard error of one."""
    records = [carriage.record(noise=noise(600, 1e-4, seed=s), name=f"r{s}") for s in range(4)]
    one, four = fit(make_model(), records[:1]), fit(make_model(), records)
    np.testing.assert_allclose(of_noise(four) / of_noise(one), 0.5, rtol=0.12)


@pytest.mark.parametrize("horizon", [None, 100])
def test_a_machine_that_truly_sticks_is_covered_although_the_model_creeps(carriage_like, make_model, horizon):
    """Without noise, all of the error is that of smoothing sign(v): seen, said, and of the right size."""
    dry = carriage_like(epsilon=2e-6)
    model = make_model(adjust={"carriage.epsilon": {"guess": 1e-4}})
    found = fit(model, [dry.record()], FitSettings(horizon=horizon))
    error = np.array([p.value - dry.truth[p.name] for p in found.parameters])
    moved = np.array([p.smoothing for p in found.parameters])
    assert np.all(np.abs(error) <= 1.96 * np.array([p.std for p in found.parameters]))
    np.testing.assert_allclose(moved / error, 1.0, atol=0.4)
    said = "mostly that of smoothing sign(v) over carriage.epsilon = 100 µm/s: where"
    assert any(said in note for note in found.warnings)


def test_a_model_without_sign_is_not_smoothed(make_model, noisy):
    found = fit(make_model(("viscous", "offset")), [noisy])
    assert [p.smoothing for p in found.parameters] == [0.0, 0.0, 0.0]
