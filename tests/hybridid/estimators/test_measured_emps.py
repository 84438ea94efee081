"""The numbers promised on the measured EMPS records (Janot, Gautier, Brunot 2019)."""

from __future__ import annotations

from pathlib import Path

import pytest

from hybridid.estimators import FitSettings, fit
from hybridid.model import compose
from hybridid.plants.emps import EMPS
from hybridid.records.mapping import SignalMap, TimeMap, build_record
from hybridid.records.record import Record
from hybridid.validation import free_run, horizon_run, metrics

THESIS = ["viscous", "coulomb", "offset"]


@pytest.fixture(scope="module")
def records(measured: Path) -> dict[str, Record]:
    force = SignalMap("force", "N", "vir", factor="gtau")
    position = SignalMap("position", "m", "qm")
    files = {"identification": "DATA_EMPS.mat", "validation": "DATA_EMPS_PULSES.mat"}
    return {
        name: build_record(name, [measured / "emps" / file], TimeMap("t"), [force], [position])
        for name, file in files.items()
    }


def millimetres(prediction) -> float:
    return 1e3 * metrics(prediction, "gray")[0].rmse


def test_the_thesis_model_fitted_free_run(records):
    model = compose(EMPS(), THESIS)
    estimate = fit(model, [records["identification"]])
    assert estimate.converged
    assert millimetres(free_run(model, estimate.values, records["identification"])) <= 2.6
    assert estimate.seconds["solve"] < 20, "under 2 s on a machine with nothing else to do"


def test_the_thesis_model_fitted_over_one_second(records):
    model = compose(EMPS(), THESIS)
    estimate = fit(model, [records["identification"]], FitSettings(horizon=1000))
    assert estimate.converged
    assert not any(p.at_bound or not p.identifiable for p in estimate.parameters)
    for record, limit in (("identification", 0.48), ("validation", 0.60)):
        assert millimetres(horizon_run(model, estimate.values, records[record], 1000)) <= limit


def test_friction_by_direction_is_the_authors(records):
    model = compose(EMPS(), [*THESIS, "asymmetric_viscous"])
    estimate = fit(model, [records["identification"]], FitSettings(horizon=1000))
    difference = {p.name: p for p in estimate.parameters}["carriage.asymmetric_viscous.df_v"]
    assert estimate.converged
    assert difference.value == pytest.approx(73.7, rel=0.03)
    assert abs(difference.value - 73.7) < 1.96 * difference.std
    for record, limit in (("identification", 0.135), ("validation", 0.39)):
        assert millimetres(horizon_run(model, estimate.values, records[record], 1000)) <= limit


def test_multiple_shooting_finds_the_same_optimum(records):
    """Ten seconds of the record, so that it stays quick."""
    model, made = compose(EMPS(), THESIS), records["identification"].part(0, 10_000)
    fast = fit(model, [made], FitSettings(horizon=1000))
    thesis = FitSettings(method="multiple_shooting", horizon=1000, interval=250)
    slow = fit(model, [made], thesis)
    assert slow.converged
    assert slow.cost == pytest.approx(fast.cost, rel=1e-5)
    for a, b in zip(fast.parameters, slow.parameters, strict=True):
        assert b.value == pytest.approx(a.value, abs=0.02 * a.std)
