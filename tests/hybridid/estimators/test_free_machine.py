"""A machine without an input is a machine: one that is let go and swings."""

from __future__ import annotations

import numpy as np
import pytest

from hybridid.declarations import Parameter, Port, Signal, State
from hybridid.estimators.fit import fit
from hybridid.model import compose
from hybridid.plants.plant import Motion, Plant
from hybridid.records.record import Channel, Record
from hybridid.settings.fit import FitSettings

DT, N = 0.02, 300


class Released(Plant):
    """``q'' = -k q - F``."""

    name, meaning, source = "released", "a mass on a spring, let go", "a test"
    states = (
        State("q", "m", observed_by="position"),
        State("v", "m/s", scale=3.0, observed_by="position", derivative=1),
    )
    inputs = ()
    outputs = (Signal("position", "m"),)
    parameters = (Parameter("k", "1/s²", 5.0, 0.1, 100.0),)
    ports = (Port("guide", "effort", "m/s²", 1.0, "m", 1.0, 3.0, 0.01),)

    def motion(self, x, u, p):
        return {"guide": Motion(position=x.q, velocity=x.v)}

    def derivative(self, x, u, p, effort):
        return {"q": x.v, "v": -p.k * x.q - effort["guide"]}

    def output(self, x, u, p):
        return {"position": x.q}


@pytest.mark.parametrize("method", ["gauss_newton", "multiple_shooting"])
def test_parameters_of_a_free_oscillation(method):
    time = DT * np.arange(N)
    w = np.sqrt(9.0 - 0.1**2)
    position = np.exp(-0.1 * time) * (np.cos(w * time) + 0.1 / w * np.sin(w * time))
    record = Record(
        "let_go", time, np.empty((N, 0)), position[:, None], (), (Channel("position", "m"),), source="a test"
    )
    estimate = fit(compose(Released(), ["viscous"]), [record], FitSettings(method=method))
    assert estimate.values["k"] == pytest.approx(9.0, rel=1e-4)
    assert estimate.values["guide.viscous.f_v"] == pytest.approx(0.2, rel=1e-3)
