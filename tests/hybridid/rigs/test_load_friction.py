"""Load friction planted in the virtual EMPS is found by a fit: the plant's load is the rig's."""

from __future__ import annotations

from dataclasses import replace

import pytest

from hybridid.estimators import FitSettings, fit
from hybridid.model import compose
from hybridid.plants.emps import EMPS
from hybridid.rigs.emps import DEFAULT, EMPSRig, EMPSTruth
from hybridid.rigs.truth import at

TRUTH = EMPSTruth(M=95.0, f_v=203.0, f_c=20.4, offset=-3.2)
SETTINGS = FitSettings(horizon=500)
# the rig sticks exactly: a model that creeps at up to 3e-4 m/s takes some 0.002 of it for load friction
SHARP = {"carriage.epsilon": {"fixed": 5e-5}}
SYMMETRIC = ["viscous", "coulomb", "offset"]


@pytest.mark.parametrize("mu", [0.03, 0.1])
def test_a_fit_finds_the_planted_share_of_the_load_again(mu):
    rig = EMPSRig(replace(DEFAULT, truth=replace(TRUTH, planted=(at("carriage", "load_friction", mu=mu),))))
    record = rig.record("identification", duration=12.0)
    poor = fit(compose(EMPS(), SYMMETRIC, SHARP), [record], SETTINGS)
    found = fit(compose(EMPS(), [*SYMMETRIC, "load_friction"], SHARP), [record], SETTINGS)
    assert found.values["carriage.load_friction.mu"] == pytest.approx(mu, rel=0.03)
    assert found.values["M"] == pytest.approx(TRUTH.M, rel=0.005)
    assert found.values["carriage.coulomb.f_c"] == pytest.approx(TRUTH.f_c, rel=0.02)
    assert found.cost < 0.1 * poor.cost
