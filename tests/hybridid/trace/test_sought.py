"""Starts that are looked for in the record: near the truth, whatever the declared guesses."""

from __future__ import annotations

import numpy as np
import pytest

from hybridid.effects.library import effect_named
from hybridid.trace.candidates import Candidate
from hybridid.trace.refit import refit
from hybridid.trace.sought import sought
from hybridid.trace.trial import attempt

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
