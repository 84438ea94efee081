"""Pitches of which hundreds lie in one record, from the spectrum of the missing effort over position."""

from __future__ import annotations

import numpy as np
import pytest

from hybridid.effects.library import effect_named
from hybridid.trace.candidates import Candidate
from hybridid.trace.horizons.split import by_record
from hybridid.trace.refits.refit import refit
from hybridid.trace.starts.order_spectrum import lines, pitches
from hybridid.trace.starts.sought import PERIODS
from hybridid.trace.trials.trial import attempt

PITCH = 0.0437  # m, of which some 200 lie along the way
SAMPLES, HORIZON = 4000, 100


@pytest.fixture(scope="module")
def travelling(carriage_like, noise):
    """A carriage that travels 10 m in 20 s, and one a little slower; its cogging is given."""

    class Travelling(carriage_like):
        def force(self, time):
            return 120.0 + 40.0 * np.sin(2 * np.pi * 0.3 * time)

    class Slower(Travelling):
        def force(self, time):
            return 0.9 * super().force(1.1 * time)

    def make(**truth):
        records = (
            kind(**truth).record(SAMPLES, noise=noise(SAMPLES, 2e-6, seed=k), name=kind.__name__)
            for k, kind in enumerate((Travelling, Slower))
        )
        first, second = records
        return by_record([first], [second], HORIZON)

    return make


@pytest.fixture(scope="module")
def finely_rippled(make_model, travelling):
    """The symmetric model, fitted to a carriage with cogging of a fine pitch."""
    split = travelling(ripple=3.0, pitch=PITCH)
    return split, refit(make_model(), split)


def test_a_pitch_too_fine_for_the_grid_is_found(finely_rippled):
    split, base = finely_rippled
    found = pitches(base, split, "carriage", PERIODS)
    span = np.ptp(split.records[0].outputs)
    assert span / PITCH > 4 * PERIODS
    assert min(abs(span / pitch - span / PITCH) for pitch in found) < 0.5


def test_with_it_the_trial_finds_the_cogging(finely_rippled):
    split, base = finely_rippled
    trial = attempt(Candidate(effect_named("cogging"), "carriage"), base, split)
    values = trial.own("values")
    assert trial.gain > 0.8
    assert values["pitch"] == pytest.approx(PITCH, rel=1e-4)
    assert np.hypot(values["A_s"], values["A_c"]) == pytest.approx(3.0, rel=0.05)


def test_a_machine_without_a_ripple_has_no_line(make_model, travelling):
    split = travelling()
    assert pitches(refit(make_model(), split), split, "carriage", PERIODS) == []


def test_noise_shows_a_line_as_rarely_as_it_says():
    power = np.random.default_rng(1).exponential(size=(400, 2000))
    assert sum(bool(lines(row, 80)) for row in power) <= 12  # 4 are expected, 12 once in a thousand times
    power[:, 700] += 60.0
    assert all(lines(row, 80)[0] == 700 for row in power)
    assert not any(lines(row, 800) == [700] for row in power), "what the grid covers is left to it"
