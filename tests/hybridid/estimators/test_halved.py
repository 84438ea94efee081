"""Results do not depend on how finely they are computed: epsilon, step and tolerance are halved."""

from __future__ import annotations

from dataclasses import replace

import pytest

from hybridid.estimators import FitSettings, fit

EPSILON = 1e-4
"""m/s, of the model; that of the truth is a fiftieth of it."""
FREE_RUN, PREDICTION = FitSettings(), FitSettings(horizon=50)
MAY_MOVE = {"epsilon": 1.0, "step": 0.05, "tolerance": 1e-3}
"""By how many standard errors. They allow for epsilon: smoothing sign(v) is a part of each."""


@pytest.fixture(scope="module")
def dry(carriage_like, noise):
    """A carriage with dry friction as an encoder with white noise of 10 µm records it, simulated."""
    return carriage_like(epsilon=EPSILON / 50).record(noise=noise(600, 1e-5, seed=4))


@pytest.fixture(scope="module")
def smoothed(make_model):
    """The model with a smoothing velocity in m/s."""
    return lambda epsilon: make_model(adjust={"carriage.epsilon": {"guess": epsilon}})


@pytest.fixture(scope="module", params=[FREE_RUN, PREDICTION], ids=["free run", "N-step prediction"])
def fitted(request, smoothed, dry):
    """Settings, and the fit."""
    return request.param, fit(smoothed(EPSILON), [dry], request.param)


@pytest.mark.parametrize("halved", MAY_MOVE)
def test_a_finer_fit_finds_the_same(smoothed, dry, fitted, halved):
    settings, before = fitted
    same_steps = replace(settings, substeps=before.substeps)
    epsilon, finer = {
        "epsilon": (EPSILON / 2, same_steps),
        "step": (EPSILON, replace(settings, substeps=2 * before.substeps)),
        "tolerance": (EPSILON, replace(same_steps, tolerance=settings.tolerance / 2)),
    }[halved]
    after = fit(smoothed(epsilon), [dry], finer)
    assert before.converged
    assert after.converged
    moved = {p.name: abs(after.values[p.name] - p.value) / p.std for p in before.parameters}
    assert max(moved.values()) < MAY_MOVE[halved], moved
    if halved == "tolerance":
        assert after.cost == pytest.approx(before.cost, rel=1e-7)
