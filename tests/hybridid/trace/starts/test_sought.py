"""Starts that are looked for in the record: near the truth, whatever the declared guesses."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from hybridid.effects.library import effect_named
from hybridid.records.record import Record
from hybridid.simulation import simulate
from hybridid.trace.candidates import Candidate
from hybridid.trace.horizons.split import by_record
from hybridid.trace.refits.refit import refit
from hybridid.trace.starts.sought import sought
from hybridid.trace.trials.trial import attempt

HORIZON = 50  # samples, 0.25 s
PITCH = 0.0137  # m; none of the declared starts is near it


@pytest.fixture(scope="module")
def rippled(make_model, split_of):
    """The symmetric model, fitted to a carriage with cogging."""
    split = split_of(ripple=3.0, pitch=PITCH)
    return split, refit(make_model(), split)


def test_a_pitch_is_found(rippled):
    split, base = rippled
    candidate = Candidate(effect_named("cogging"), "carriage")
    model = candidate.added_to(base.model)
    starts = sought(candidate, model, base, split)
    found = [start["carriage.cogging.pitch"] for start in starts]
    assert min(abs(pitch / PITCH - 1) for pitch in found) < 0.03
    assert all(start["carriage.cogging.A_s"] == 0.0 for start in starts)
    declared = [start["carriage.cogging.pitch"] for start in candidate.starts(model, base.values)]
    assert min(abs(pitch / PITCH - 1) for pitch in declared) > 0.1


def test_with_it_the_refit_finds_the_ripple(rippled):
    split, base = rippled
    trial = attempt(Candidate(effect_named("cogging"), "carriage"), base, split)
    assert trial.gain > 0.8
    values = trial.own("values")
    assert values["pitch"] == pytest.approx(PITCH, rel=1e-3)
    assert np.hypot(values["A_s"], values["A_c"]) == pytest.approx(3.0, rel=0.05)


def test_most_effects_seek_nothing(rippled):
    split, base = rippled
    for name in ("stribeck", "asymmetric_viscous", "input_delay"):
        effect = effect_named(name)
        port = "force" if effect.kind == "input" else "carriage"
        candidate = Candidate(effect, port)
        assert sought(candidate, candidate.added_to(base.model), base, split) == []


def test_a_period_of_a_sensor_is_sought_over_what_it_shows(make_model, split_of):
    """Both records of the carriage read through an encoder whose error repeats every 7 mm."""
    period, split = 7e-3, split_of()
    split = replace(split, records=tuple(_rippled(record, period, 2e-4) for record in split.records))
    base = refit(make_model(), split)
    candidate = Candidate(effect_named("sensor_periodic_error"), "position")
    name = f"{candidate.name}.period"
    starts = sought(candidate, candidate.added_to(base.model), base, split)
    assert min(abs(start[name] / period - 1) for start in starts) < 0.05
    trial = attempt(candidate, base, split)
    assert trial.gain > 0.8
    assert trial.own("values")["period"] == pytest.approx(period, rel=0.01)
    assert trial.not_shown == ""


def _rippled(record: Record, period: float, amplitude: float) -> Record:
    error = amplitude * np.sin(2 * np.pi * record.outputs / period)
    return replace(record, outputs=record.outputs + error)


def test_a_resonance_slower_than_a_horizon_is_sought(make_model, two_records):
    """A load behind a spring, with a period of two horizons: its inner states are handed on."""
    slow, mode, model = 2.0, Candidate(effect_named("flexible_mode"), "carriage"), make_model()
    with_mode, truth = mode.added_to(model), {"m_l": 15.0, "frequency": slow, "zeta": 0.03}
    values = {p.name: p.guess for p in with_mode.parameters}
    values |= {"M": 80.0, "carriage.viscous.f_v": 200.0, "carriage.coulomb.f_c": 20.0}
    values |= {f"{mode.name}.{name}": value for name, value in truth.items()}
    rest = np.zeros(len(with_mode.states))
    records = [
        replace(r, outputs=simulate(with_mode, values, r, rest, substeps=4).outputs) for r in two_records()
    ]
    split = by_record(records[:1], records[1:], HORIZON)
    assert slow * HORIZON * records[0].dt == 0.5
    base = refit(model, split)
    found = [start[f"{mode.name}.frequency"] for start in sought(mode, with_mode, base, split)]
    assert min(abs(frequency / slow - 1) for frequency in found) < 0.15
    trial = attempt(mode, base, split)
    assert trial.own("values")["frequency"] == pytest.approx(slow, rel=0.02)
