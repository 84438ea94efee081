"""The measured records pass through map and check unharmed (needs $HYBRIDID_DATA, see data/README.md)."""

from __future__ import annotations

import os
from math import pi
from typing import Any

import numpy as np
import pytest

from hybridid.records.mapping import read_record, record_map
from hybridid.records.record import Record
from hybridid.records.sources import RecordNotFoundError, data_roots

ROOT = os.environ.get("HYBRIDID_DATA")
pytestmark = pytest.mark.skipif(not ROOT, reason="HYBRIDID_DATA names no folder with the measured records")


def read(**plan: Any) -> Record:
    try:
        return read_record("measured", record_map(plan), data_roots())
    except RecordNotFoundError as missing:
        pytest.skip(str(missing))


@pytest.mark.parametrize(
    ("file", "digest", "forces"),
    [
        ("DATA_EMPS.mat", "6cf6814ae146", (-152.0498356, 145.4703589)),
        ("DATA_EMPS_PULSES.mat", "0eab75bb1f6b", (-279.0181210, 317.5617925)),
    ],
)
def test_emps(file, digest, forces):
    record = read(
        files=f"emps/{file}",
        time={"column": "t"},
        inputs={"force": {"unit": "N", "column": "vir", "factor": "gtau"}},
        outputs={"position": {"unit": "m", "column": "qm"}},
        auxiliary={"reference": {"unit": "m", "column": "qg"}},
    )
    assert record.warnings == ()
    assert record.n == 24841
    assert record.dt == pytest.approx(1e-3, rel=1e-6)
    assert record.digest.startswith(digest)
    force = record.input("force")
    np.testing.assert_allclose((force.min(), force.max()), forces, rtol=1e-8)
    assert np.abs(record.output("position") - record.signal("reference")).max() < 0.01


@pytest.mark.parametrize(("file", "peak"), [("SNLS80mV.csv", 0.14945), ("Schroeder80mV.csv", 0.1118)])
def test_silverbox(file, peak):
    record = read(
        files=f"silverbox/{file}",
        time={"rate": 610.35},
        inputs={"drive": {"unit": "V", "column": "V1", "hold": "bandlimited"}},
        outputs={"response": {"unit": "V", "column": "V2"}},
    )
    assert record.warnings == ()
    assert record.n == 131072
    assert record.input("drive").max() == pytest.approx(peak, rel=1e-12)


def test_flexible_link():
    record = read(
        files=[f"quanser_flexible_link/data_{name}.mat" for name in ("vm", "theta", "alpha")],
        time={"column": "data_vm[0]", "same": ["data_theta[0]", "data_alpha[0]"]},
        inputs={"voltage": {"unit": "V", "column": "data_vm[1]"}},
        outputs={
            "servo": {"unit": "rad", "column": "data_theta[2]", "scale": pi / 180},
            "tip": {"unit": "rad", "column": "data_alpha[1]", "scale": pi / 180},
        },
        auxiliary={"reference": {"unit": "rad", "column": "data_theta[1]", "scale": pi / 180}},
    )
    assert record.warnings == ()
    assert record.n == 2500
    assert record.dt == pytest.approx(2e-3, rel=1e-9)
    assert record.time[0] == pytest.approx(2e-3)
    assert np.abs(record.output("servo")).max() == pytest.approx(0.529223, rel=1e-5)
