"""The flexible link: its motor, and a fit to the measured one."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from hybridid.estimators import fit
from hybridid.model import compose
from hybridid.plants.flexible_link import FlexibleLink
from hybridid.records.mapping import build_record, record_map
from hybridid.records.record import Record
from hybridid.validation.metrics import metrics
from hybridid.validation.predict import free_run

DEGREE = float(np.pi / 180)


def test_the_motor_stalls_and_runs_free_as_its_constants_say():
    model = compose(FlexibleLink())
    p = dict(zip([q.name for q in model.parameters], model.values(), strict=True))
    stalled = np.asarray(model.f(0, [0, 0, 0, 0], 6.0, model.values())).ravel()
    torque = p["eta_g"] * p["eta_m"] * p["K_g"] * p["k_t"] * 6.0 / p["R_m"]
    assert stalled[1] == pytest.approx(torque / p["J_eq"])
    assert stalled[3] == pytest.approx(-stalled[1]), "the tip stays where it is"
    free_speed = 6.0 / (p["K_g"] * p["k_m"])
    running = np.asarray(model.f(0, [0, free_speed, 0, 0], 6.0, model.values())).ravel()
    np.testing.assert_allclose(running, [free_speed, 0, 0, 0], atol=1e-9)


@pytest.fixture(scope="module")
def link(measured: Path) -> Record:
    folder = "quanser_flexible_link"
    plan = record_map(
        {
            "files": [f"{folder}/data_{name}.mat" for name in ("vm", "theta", "alpha")],
            "time": {"column": "data_vm[0]", "same": ["data_theta[0]", "data_alpha[0]"]},
            "inputs": {"voltage": {"column": "data_vm[1]", "unit": "V", "hold": "zoh"}},
            "outputs": {
                "servo_angle": {"column": "data_theta[2]", "unit": "rad", "scale": DEGREE},
                "tip_angle": {"column": "data_alpha[1]", "unit": "rad", "scale": DEGREE},
            },
        }
    )
    files = [measured / file for file in plan.files]
    return build_record("flexible_link", files, plan.time, plan.inputs, plan.outputs)


def test_the_measured_link_is_near_its_manual(link):
    model = compose(FlexibleLink(), ["viscous@servo", "coulomb@servo", "offset@servo"])
    estimate = fit(model, [link])
    assert estimate.converged
    for name, manual in (("J_eq", 0.00208), ("J_l", 0.065 * 0.419**2 / 3), ("K_s", 1.3)):
        assert estimate.values[name] == pytest.approx(manual, rel=0.3)
    assert 0.005 < estimate.values["servo.coulomb.f_c"] < 0.05, "N·m, as its authors found"
    servo, tip = metrics(free_run(model, estimate.values, link), "gray box")
    assert servo.r2 > 0.99
    assert tip.r2 > 0.97
