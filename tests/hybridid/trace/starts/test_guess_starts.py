"""Driven slowly, an oscillator without its Coulomb friction ends with a tenth of its mass."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from hybridid.effects.library import effect_named
from hybridid.model import compose
from hybridid.plants.duffing import Duffing
from hybridid.records.channel import Channel
from hybridid.records.record import Record
from hybridid.trace.candidates import Candidate
from hybridid.trace.horizons.split import by_record
from hybridid.trace.refits.refit import CONTINUATION, refit
from hybridid.trace.starts.guess_starts import FAR, with_guesses
from hybridid.trace.trials.trial import attempt

DT, SAMPLES, STEPS = 1 / 610.0, 800, 40
MASS, DAMPING, STIFFNESS, COULOMB = 3.9e-6, 2.7e-4, 1.3, 4e-3
FRICTION = Candidate(effect_named("coulomb"), "oscillator")
TONES = {6.8: 0.0099, 10.6: 0.0103, 21.4: 0.0082}  # Hz: V


def driven(name, seed):
    """A record of the oscillator with Coulomb friction, by small steps of its own."""
    dice = np.random.default_rng(seed)
    t = DT * np.arange(SAMPLES)
    u = sum(a * np.sin(2 * np.pi * f * t + dice.uniform(0, 2 * np.pi)) for f, a in TONES.items())
    y, v, h, path = 0.0, 0.0, DT / STEPS, []
    for drive in u:
        path.append(y)
        for _ in range(STEPS):
            v += h * (drive - DAMPING * v - STIFFNESS * y - COULOMB * np.tanh(v / 0.01)) / MASS
            y += h * v
    noisy = np.array(path) + 1.4e-4 * dice.standard_normal(SAMPLES)
    channels = (Channel("V1", "V"),), (Channel("V2", "V"),)
    return Record(name, t, u[:, None], noisy[:, None], *channels, simulated=True)


@pytest.fixture(scope="module")
def bent():
    split = by_record([driven("fitted", 1)], [driven("held out", 2)], 100)
    return split, refit(compose(Duffing(), []), split, factors=CONTINUATION)


def test_the_friction_is_found_from_the_guesses(bent, monkeypatch):
    split, base = bent
    assert base.values["m"] < MASS / 3
    found = attempt(FRICTION, base, split)
    assert found.gain > 0.8
    assert found.own("values")["f_c"] == pytest.approx(COULOMB, rel=0.05)
    assert found.refit.values["m"] == pytest.approx(MASS, rel=0.1)
    monkeypatch.setattr("hybridid.trace.trials.trial.from_guesses", lambda *given: None)
    assert attempt(FRICTION, base, split).gain < 0.3


def test_only_a_far_parameter_of_a_path_that_strays_begins_at_its_guess(bent):
    _, base = bent
    guesses = {p.name: p.guess for p in base.model.free}
    assert with_guesses(base) == {**base.values, **guesses}
    near = {name: guess * 0.9 * FAR for name, guess in guesses.items()}
    assert with_guesses(replace(base, values={**base.values, **near})) is None
    close = replace(base.score, squares=1e-6 * base.score.squares)
    assert with_guesses(replace(base, score=close)) is None
