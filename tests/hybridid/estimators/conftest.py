"""Fits of the simulated carriage that several tests look at."""

from __future__ import annotations

import numpy as np
import pytest

from hybridid.estimators import Estimate, FitSettings, fit
from hybridid.model import Model
from hybridid.records.record import Record

NOISE = 1e-5
"""Standard deviation of the simulated encoder in m."""


@pytest.fixture(scope="session")
def noisy(carriage, noise) -> Record:
    """Three seconds of the symmetric carriage at 200 Hz with white noise of 10 µm, simulated."""
    return carriage.record(noise=noise(600, NOISE, seed=4))


@pytest.fixture(scope="session")
def symmetric(make_model) -> Model:
    return make_model()


@pytest.fixture(scope="session")
def free_run_fit(symmetric, noisy) -> Estimate:
    return fit(symmetric, [noisy])


@pytest.fixture(scope="session")
def horizon_fit(symmetric, noisy) -> Estimate:
    return fit(symmetric, [noisy], FitSettings(horizon=50))


@pytest.fixture(scope="session")
def values_of():
    """Values of an estimate's parameters as an array."""
    return lambda estimate: np.array([p.value for p in estimate.parameters])


@pytest.fixture(scope="session")
def of_noise():
    """Standard errors less what they allow for smoothing: the simulated truth is as smooth as the model."""
    return lambda estimate: np.array([np.sqrt(p.std**2 - p.smoothing**2) for p in estimate.parameters])
