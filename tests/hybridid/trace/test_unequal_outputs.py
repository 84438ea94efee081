"""What a poor sensor hides is found once the noise of both is declared. All records here are simulated."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from hybridid.declarations import Signal
from hybridid.model import compose
from hybridid.plants.emps import EMPS
from hybridid.records.channel import Channel
from hybridid.trace.run import trace

NOISE = np.array([2e-5, 1e-2])
"""An encoder and a laser, both of the carriage's position, in m."""


class TwoSensors(EMPS):
    """EMPS with a laser beside its encoder."""

    name = "two_sensors"
    outputs = (*EMPS.outputs, Signal("laser", "m"))

    def output(self, x, u, p):
        return {"position": x.q, "laser": x.q}


@pytest.fixture(scope="module")
def record(carriage):
    """Twelve seconds of a carriage on which a constant force of -3.2 N acts."""
    one = carriage.record(2400)
    outputs = np.tile(one.outputs, 2) + np.random.default_rng(3).normal(0, NOISE, (2400, 2))
    channels = (*one.output_channels, Channel("laser", "m"))
    return replace(one, outputs=outputs, output_channels=channels, absent=None, warnings=())


def test_the_noise_of_both_sensors_shows_what_the_poor_one_hides(record):
    model = compose(TwoSensors(), ["viscous", "coulomb"])
    alike = trace(model, [record], effects=["offset"], laws=False)
    assert not alike.accepted
    assert "no effect was tried" not in alike.sentence, "the poor sensor's noise is not that of the good one"
    assert "Beware: position is measured" in alike.sentence
    channels = zip(record.output_channels, NOISE, strict=True)
    declared = replace(record, output_channels=tuple(replace(c, noise=std) for c, std in channels))
    weighed = trace(model, [declared], effects=["offset"], laws=False)
    (found,) = weighed.accepted
    assert found.parameters["offset"].value == pytest.approx(-3.2, abs=3 * found.parameters["offset"].std)
    assert "Beware: position" not in weighed.sentence
