"""A delay or lag that the sampling itself may make is told."""

from __future__ import annotations

from types import SimpleNamespace

import pytest

from hybridid.effects.library import effect_named
from hybridid.trace.candidates import Candidate
from hybridid.trace.cautions.sampling import within_half_a_sample
from hybridid.trace.search.steps import Accepted
from hybridid.trace.trials.trial import Trial

DT = 1e-3


def accepted(name, **values):
    port, effect = name.split(".")
    found = SimpleNamespace(
        values={f"{name}.{key}": value for key, (value, _) in values.items()},
        std={f"{name}.{key}": std for key, (_, std) in values.items()},
    )
    trial = Trial(Candidate(effect_named(effect), port), None, None)
    return [Accepted(trial, (trial,), ())], found, DT


def test_a_lag_of_a_third_of_a_sample_may_be_the_sampling():
    assert within_half_a_sample(*accepted("force.input_lag", T=(0.33e-3, 0.01e-3))) == (
        " Beware: the T of force.input_lag may be no more than half a sampling period (500 µs). "
        "The hold of the input or the record's time stamps make as much, if they are not as declared."
    )


@pytest.mark.parametrize("std", [0.2e-3, 0.3e-3])
def test_one_that_its_errors_do_not_tell_from_half_a_sample_may_be(std):
    assert "the delay of" in within_half_a_sample(*accepted("force.input_delay", delay=(0.9e-3, std)))


@pytest.mark.parametrize(
    "one",
    [
        accepted("force.input_delay", delay=(0.9e-3, 0.1e-3)),
        accepted("position.sensor_lag", T=(2e-3, 1e-5)),
        accepted("position.sensor_lag", T=(1.5, 3.0)),  # told as one that may be zero
        accepted("carriage.warming_friction", tau=(1e-4, 1e-6)),  # a time of the mechanism
    ],
)
def test_longer_ones_and_times_of_the_mechanism_are_not(one):
    assert within_half_a_sample(*one) == ""
