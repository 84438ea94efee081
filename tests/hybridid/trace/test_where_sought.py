"""A catch that is smaller than what a wide smoothing of sign(v) leaves of a carriage that sticks."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from hybridid.effects.library import effect_named
from hybridid.records.record import Channel, Record
from hybridid.simulation import simulate
from hybridid.trace.candidates import Candidate
from hybridid.trace.horizons.split import by_record
from hybridid.trace.refits.refit import CONTINUATION, refit
from hybridid.trace.trials import trial
from hybridid.trace.trials.trial import attempt

N, DT, LONG = 1200, 0.005, 200  # samples, s, samples of a horizon
CATCH = Candidate(effect_named("detent"), "carriage")
FRICTION = ("viscous", "coulomb", "offset")
TRUTH = {
    "M": 75.0,
    "carriage.viscous.f_v": 200.0,
    "carriage.coulomb.f_c": 30.0,
    "carriage.offset.offset": -3.0,
    "carriage.detent.F_d": 2.0,
    "carriage.detent.q_0": -0.03,
    "carriage.detent.w": 0.01,
}


@pytest.fixture(scope="module")
def split(make_model):
    """A fitted and a held-out record: three sines of force, solved with a much sharper sign(v)."""
    sharp = make_model((*FRICTION, "detent"), {"carriage.epsilon": {"guess": 5e-5}})
    values = {p.name: p.guess for p in sharp.parameters} | TRUTH
    records = []
    for seed in (1, 2):
        random, time = np.random.default_rng(seed), np.arange(N) * DT
        lines = zip((60, 50, 40), random.uniform(0.2, 1.3, 3), random.uniform(0, 6, 3), strict=True)
        force = sum(a * np.sin(2 * np.pi * f * time + phase) for a, f, phase in lines)
        record = Record(
            name=f"run {seed}",
            time=time,
            inputs=force[:, None],
            outputs=random.normal(size=(N, 1)),
            input_channels=(Channel("force", "N", "zoh"),),
            output_channels=(Channel("position", "m"),),
        )
        moved = simulate(sharp, values, record, np.zeros(2), 20).outputs
        records.append(replace(record, outputs=moved + random.normal(size=(N, 1)) * 1e-5))
    return by_record(records[:1], records[1:], LONG)


def test_a_place_is_kept_that_a_descent_through_wider_smoothings_leaves(split, make_model, monkeypatch):
    base = refit(make_model(FRICTION, {"carriage.epsilon": {"guess": 5e-4}}), split, factors=CONTINUATION)
    found = attempt(CATCH, base, split).own("values")
    assert found["q_0"] == pytest.approx(-0.03, abs=0.003)
    assert found["F_d"] == pytest.approx(2.0, rel=0.05)
    monkeypatch.setattr(trial, "_unless_better_where_sought", lambda found, *given: found)
    assert attempt(CATCH, base, split).own("values")["F_d"] < 0  # a hump, at another place
