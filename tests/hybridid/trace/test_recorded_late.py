"""A force that was recorded through a filter is no load, play or gain: the trace says that it is late.

The oscillator is linear and driven by a sum of cosines, so that its records are known exactly (simulated).
"""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from hybridid.effects.library import effect_named
from hybridid.model import compose
from hybridid.plants.duffing import Duffing
from hybridid.records.record import Channel, Record
from hybridid.trace.candidates import Candidate
from hybridid.trace.cautions.sampling import outputs_late, recorded_late
from hybridid.trace.run import trace

MASS, DAMPING, STIFFNESS, LAG = 5e-6, 4e-4, 1.0, 1.5e-3
DT, SAMPLES, NOISE = 2.5e-4, 3000, 2e-5


def _record(seed: int) -> Record:
    rng = np.random.default_rng(seed)
    time, omega = DT * np.arange(SAMPLES), 2 * np.pi * 10 ** rng.uniform(0, 2, 24)
    force = 0.0144 * np.exp(1j * rng.uniform(0, 2 * np.pi, 24))
    waves = np.exp(1j * np.outer(time, omega))
    motion = (waves @ (force / (STIFFNESS - MASS * omega**2 + 1j * omega * DAMPING))).real
    recorded = (waves @ (force / (1 + 1j * omega * LAG))).real
    seen = motion + NOISE * rng.standard_normal(SAMPLES)
    channels = (Channel("V1", "V", hold="foh"),), (Channel("V2", "V"),)
    return Record(f"run_{seed}", time, recorded[:, None], seen[:, None], *channels, simulated=True)


def test_a_force_that_was_recorded_late_is_told():
    effects = ["input_record_lag", "sensor_lag"]
    asked = {"effects": effects, "variables": ("velocity",), "laws": False, "pairs": 0}
    found = trace(compose(Duffing()), [_record(1)], [_record(2)], **asked)
    (first, *_) = found.accepted
    assert first.effect == "input_record_lag"
    assert first.parameters["T"].value == pytest.approx(LAG, rel=0.01)
    for name, true in (("m", MASS), ("d", DAMPING), ("k", STIFFNESS)):
        assert found.estimates.after[name].value == pytest.approx(true, rel=0.01)
    assert "answers before it is driven" in found.words


def accepted(*effects: str):
    ports = {"input_record_lag": "V2", "sensor_lag": "V2", "input_delay": "V1", "input_lag": "V1"}
    trials = tuple(
        SimpleNamespace(candidate=Candidate(effect_named(one), ports.get(one, "oscillator")))
        for one in effects
    )
    return [SimpleNamespace(trial=trials[0], alike=trials)]


def test_a_delay_of_an_input_may_be_one_of_the_outputs():
    assert outputs_late(accepted("input_lag")) == ""
    said = outputs_late(accepted("input_lag", "input_delay"))
    assert said.startswith(" Beware: V1.input_delay may as well be a delay of the outputs")


def test_a_fault_of_the_recording_is_told_also_of_a_class():
    assert recorded_late(accepted("sensor_lag")) == ""
    said = recorded_late(accepted("input_record_lag"))
    assert said.startswith(" Beware: V2.input_record_lag says")
    assert recorded_late(accepted("backlash", "input_record_lag")) == said
