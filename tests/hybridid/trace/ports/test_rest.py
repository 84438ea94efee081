"""Where friction holds a machine at rest, no missing effort is shown. Simulated."""

from __future__ import annotations

import numpy as np
import pytest

from hybridid.model.compose import compose
from hybridid.plants.emps import EMPS
from hybridid.records.record import Channel, Record
from hybridid.rigs.law_library import COULOMB, VISCOUS
from hybridid.rigs.machine import Machine, Motion
from hybridid.trace.ports.missing_effort import missing_effort

DT, N, M, F_V, F_C = 1e-3, 3000, 95.0, 200.0, 20.0
VALUES = {"M": M, "carriage.viscous.f_v": F_V, "carriage.coulomb.f_c": F_C}


@pytest.fixture(scope="module")
def stops() -> Record:
    """A carriage that is pushed for 1.5 s, then held by its friction against half of its level."""
    motion = Motion(Machine(((M,),), ((1.0,),), ((1.0,),), ((VISCOUS(f_v=F_V), COULOMB(f_c=F_C)),)), [0.0])
    time = DT * np.arange(N)
    force = np.where(time < 1.5, 60.0 * np.sin(2 * np.pi * time / 1.5), 0.5 * F_C)
    position = np.empty(N)
    for k, u in enumerate(force):
        position[k] = motion.positions[0]
        motion.advance(DT, np.array([u]))
    position += 1e-6 * np.random.default_rng(0).standard_normal(N)
    channels = (Channel("force", "N", "zoh"),), (Channel("position", "m"),)
    return Record("stops", time, force[:, None], position[:, None], *channels, simulated=True)


def test_what_friction_takes_up_at_rest_is_not_shown(stops):
    found = missing_effort(compose(EMPS(), ("viscous", "coulomb")), VALUES, stops, "carriage")
    assert found.rests
    assert found.rows is not None
    assert 1400 < len(found.rows) < 2000
    assert np.sqrt(np.mean(found.effort**2)) < 0.15 * F_C


def test_a_model_without_friction_lacks_it_at_rest_too(stops):
    found = missing_effort(
        compose(EMPS(), ("viscous",)), {"M": M, "carriage.viscous.f_v": F_V}, stops, "carriage"
    )
    assert not found.rests
    assert found.rows is None
    assert found.effort[-500:].mean() == pytest.approx(0.5 * F_C, rel=0.05)
