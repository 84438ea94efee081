"""A known error process, and small networks trained on it, that several tests look at."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from scipy.signal import lfilter

from hybridid.residuals.orders import Orders
from hybridid.residuals.series import ErrorSeries, Surroundings
from hybridid.residuals.settings import Architecture, Training
from hybridid.residuals.training import Task, Trained, train

DT = 0.01
"""s"""


def make_series(n: int, seed: int, noise: float = 1e-3) -> ErrorSeries:
    """``e(t) = 1.2 e(t-1) - 0.5 e(t-2) + 0.3 tanh(u(t-1)) + 0.2 y(t-1)²``, y a lag of u, simulated."""
    rng = np.random.default_rng(seed)
    u = np.convolve(rng.normal(size=n + 8), np.full(8, 8**-0.5), "valid")[:n]
    gray = lfilter([0.0, 0.1], [1.0, -0.9], u)
    error = np.zeros(n)
    for t in range(2, n):
        error[t] = 1.2 * error[t - 1] - 0.5 * error[t - 2] + 0.3 * np.tanh(u[t - 1]) + 0.2 * gray[t - 1] ** 2
    seen = Surroundings("y", "m", DT, u[:, None], ("u",), gray, (0,))
    return ErrorSeries(f"record {seed}", "simulated", error + noise * rng.normal(size=n), seen)


@pytest.fixture(scope="session")
def series() -> Callable[..., ErrorSeries]:
    """``series(n, seed)``"""
    return make_series


@pytest.fixture(scope="session")
def small() -> Architecture:
    return Architecture(Orders(error=2, inputs=(2,), gray=1), depth=2, width=8)


@pytest.fixture(scope="session")
def brief() -> Training:
    """A training of a second."""
    return Training(horizons=(1, 20), epochs=40, patience=8, batch=256, learning_rate=5e-3)


@pytest.fixture(scope="session")
def trained(small: Architecture, brief: Training) -> Trained:
    return train(Task((make_series(2000, 0),), small, seed=3), brief)
