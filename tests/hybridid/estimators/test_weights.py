"""Errors weighed by the noise of each output's sensor. All records here are simulated."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from hybridid.advice.unequal import unequal_outputs
from hybridid.estimators import FitSettings, fit
from hybridid.estimators.problem import output_scale
from hybridid.quality import judge
from hybridid.signals.simple import Scale

TRUTH = {"M": 2.0, "d": 3.0}
NOISE = np.array([1e-5, 0.2])
"""A good encoder in m, and a poor tachometer in m/s."""
SETTINGS = {
    "free run": FitSettings(),
    "horizons": FitSettings(horizon=100),
    "multiple shooting": FitSettings(method="multiple_shooting", interval=50),
}


@pytest.fixture(scope="module")
def record(sledge_record):
    return sledge_record(NOISE)


def declared(record, noise=NOISE):
    """``record`` with its noise declared."""
    channels = zip(record.output_channels, noise, strict=True)
    return replace(record, output_channels=tuple(replace(c, noise=std) for c, std in channels))


@pytest.mark.parametrize("kind", SETTINGS)
def test_the_good_sensor_decides_where_the_noise_is_declared(sledge, record, kind):
    alike, weighed = (fit(sledge, [one], SETTINGS[kind]) for one in (record, declared(record)))
    for one, also in zip(weighed.parameters, alike.parameters, strict=True):
        assert abs(one.value - TRUTH[one.name]) < 4 * one.std
        assert one.std < 0.02 * also.std


def test_the_noise_of_several_records_is_pooled(record):
    assert output_scale([declared(record), declared(record, 7 * NOISE)]) == pytest.approx(5 * NOISE)
    assert output_scale([record]) == pytest.approx(record.outputs.std(axis=0))


def test_noise_of_one_output_alone_is_refused(sledge, record):
    with pytest.raises(ValueError, match="not for speed: give it for each or none"):
        fit(sledge, [declared(record, (1e-5, 0.0))])


def test_a_scaled_output_keeps_its_weight(record):
    scaled = Scale(("position",), -1e3, "mm").apply(declared(record))
    assert output_scale([scaled]) == pytest.approx([1e-2, 0.2])


def test_very_unequal_sensors_are_told_with_what_weighs_them(sledge, sledge_record, record):
    (one,) = unequal_outputs([record])
    settings = dict(part.split("=") for part in one.said.split() if part.startswith("+signals"))
    found = [float(settings[f"+signals.outputs.{name}.noise"]) for name in ("position", "speed")]
    assert found == pytest.approx(NOISE, rel=0.4)
    assert one in judge(sledge, [record], fit(sledge, [record])).advice
    assert not list(unequal_outputs([declared(record)]))
    assert not list(unequal_outputs([sledge_record(np.array([2e-3, 1e-2]))]))
