"""Rubber relaxes by more than one exponential: a second branch is tried beside the first, and named.

The oscillator stands on two Maxwell elements. Its records are the exact solution of the linear equations
under a held input (simulated).
"""

from __future__ import annotations

import numpy as np
import pytest
from scipy.linalg import expm

from hybridid.effects.library import effect_named
from hybridid.model import compose
from hybridid.plants.duffing import Duffing
from hybridid.records.record import Channel, Record
from hybridid.trace.candidates import admissible
from hybridid.trace.run import trace

MASS, DAMPING, STIFFNESS = 5e-6, 2e-4, 1.0
SLOW, FAST = (0.25, 0.08), (0.4, 0.004)
"""Stiffness and relaxation time [s] of each branch."""
DT, SAMPLES, NOISE = 1e-3, 1500, 2e-5
BRANCHES = tuple(map(effect_named, ("maxwell", "second_maxwell")))


def _record(seed: int) -> Record:
    rng = np.random.default_rng(seed)
    time = DT * np.arange(SAMPLES)
    tones, phases = 10 ** rng.uniform(-0.3, 2.0, 24), rng.uniform(0, 2 * np.pi, 24)
    force = 0.015 * np.cos(2 * np.pi * np.outer(time, tones) + phases).sum(axis=1)
    motion = np.zeros((5, 5))  # y, its rate, the two branches, the held force
    motion[0, 1] = motion[2, 1] = motion[3, 1] = 1.0
    motion[1] = np.array([-STIFFNESS, -DAMPING, -SLOW[0], -FAST[0], 1.0]) / MASS
    motion[2, 2], motion[3, 3] = -1.0 / SLOW[1], -1.0 / FAST[1]
    step, state, seen = expm(motion * DT), np.zeros(5), np.empty(SAMPLES)
    for k, state[4] in enumerate(force):
        seen[k] = state[0]
        state = step @ state
    seen += NOISE * rng.standard_normal(SAMPLES)
    channels = (Channel("V1", "V", hold="zoh"),), (Channel("V2", "V"),)
    return Record(f"run_{seed}", time, force[:, None], seen[:, None], *channels, simulated=True)


def test_a_second_branch_is_tried_only_beside_the_first():
    def tried(declared: list[str]) -> list[str]:
        return [c.name for c in admissible(compose(Duffing(), declared), BRANCHES)]

    assert tried([]) == ["oscillator.maxwell"]
    assert tried(["maxwell"]) == ["oscillator.second_maxwell"]
    assert tried(["maxwell", "second_maxwell"]) == []


def test_two_relaxation_times_are_named_with_their_amounts():
    names = [one.id for one in BRANCHES]
    records = [_record(1)], [_record(2)]
    found = trace(compose(Duffing()), *records, effects=names, variables=("velocity",), laws=False)
    assert [one.effect for one in found.accepted] == ["maxwell", "second_maxwell"]
    for one, (stiffness, time) in zip(found.accepted, (SLOW, FAST), strict=True):
        for name, true in (("k", stiffness), ("tau", time)):
            value = one.parameters[name]
            assert value.value == pytest.approx(true, rel=0.01)
            assert abs(value.value - true) < 4 * value.std
    assert found.times < 1.2
