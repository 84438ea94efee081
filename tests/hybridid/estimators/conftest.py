"""The simulated carriage and its fits, and a simulated sledge of two sensors, that several tests look at."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.signal import cont2discrete, dlsim

from hybridid.declarations import Parameter, Signal, State
from hybridid.estimators import Estimate, FitSettings, fit
from hybridid.model import Model, compose
from hybridid.plants.plant import Plant
from hybridid.records.channel import Channel
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


class Sledge(Plant):
    """``M q'' = force - d q'``."""

    name = "sledge"
    meaning = "a sledge with two sensors"
    source = "this test"
    states = (
        State("q", "m", scale=1.0, observed_by="position", derivative=0),
        State("v", "m/s", scale=1.0, observed_by="speed", derivative=0),
    )
    inputs = (Signal("force", "N"),)
    outputs = (Signal("position", "m"), Signal("speed", "m/s"))
    parameters = (
        Parameter("M", "kg", guess=1.0, lower=0.1, upper=10.0),
        Parameter("d", "N·s/m", guess=1.0, lower=0.1, upper=10.0),
    )
    ports = ()

    def motion(self, x, u, p):
        return {}

    def derivative(self, x, u, p, effort):
        return {"q": x.v, "v": (u.force - p.d * x.v) / p.M}

    def output(self, x, u, p):
        return {"position": x.q, "speed": x.v}


@pytest.fixture(scope="session")
def sledge() -> Model:
    return compose(Sledge())


@pytest.fixture(scope="session")
def sledge_record():
    """Twelve seconds of a sledge of 2 kg, 3 N·s/m at 100 Hz; white noise (2,) of position and speed."""

    def made(noise: np.ndarray) -> Record:
        generator = np.random.default_rng(0)
        force = np.repeat(generator.uniform(-5, 5, 60), 20)
        rates = np.array([[0, 1], [0, -3.0 / 2.0]]), np.array([[0], [1 / 2.0]])
        *discrete, step = cont2discrete((*rates, np.eye(2), np.zeros((2, 1))), 0.01)
        _, outputs, _ = dlsim((*discrete, step), force)
        return Record(
            name="sledge",
            time=0.01 * np.arange(1200),
            inputs=force[:, None],
            outputs=outputs + generator.normal(0, noise, (1200, 2)),
            input_channels=(Channel("force", "N", "zoh"),),
            output_channels=(Channel("position", "m"), Channel("speed", "m/s")),
            simulated=True,
        )

    return made
