"""A fit that leaves clearly less than the noise that a record seems to tell shows that it is less."""

from __future__ import annotations

import pytest

from hybridid.estimators import FitSettings, fit
from hybridid.records.sensor_noise import SensorNoise

NOISE = 1e-5
"""Of the simulated encoder, in m, as in ``noisy``."""


@pytest.mark.parametrize(("told", "kept"), [(NOISE, True), (1.2 * NOISE, True), (3 * NOISE, False)])
def test_the_noise_is_no_more_than_what_a_fit_leaves(symmetric, noisy, monkeypatch, told, kept):
    monkeypatch.setattr("hybridid.estimators.floor.sensor_noise", lambda record: (SensorNoise(told, True),))
    (left,) = fit(symmetric, [noisy], FitSettings(horizon=50)).left
    assert left.rmse == pytest.approx(NOISE, rel=0.1)
    assert left.noise == pytest.approx(told if kept else left.rmse)
