"""The files a program reads: their form, their units, and that the fitted model comes back from them."""

from __future__ import annotations

import json
import math

import numpy as np
import pytest

from hybridid.records.store import load_record
from hybridid.simulation.simulate import Diverged
from hybridid.simulation.stability import TooStiff
from hybridid.validation import free_run, metrics
from pipelines.runner import run_stages
from pipelines.shared.fitted import fit_of, load
from pipelines.shared.predictions import predictions_in, residual_tests_in
from pipelines.shared.prepared import prepared_records
from pipelines.shared.storage import read_json, write_json


@pytest.fixture
def tree(settings, heard, data, once):
    return once("validated", lambda: run_stages(settings({"out": "tree"}), "validate", heard)).tree


def test_estimate(tree):
    estimate = json.loads((tree / "fit/estimate.json").read_text())
    assert set(estimate["parameters"]) == {
        "M", "carriage.viscous.f_v", "carriage.coulomb.f_c", "carriage.offset.offset"
    }  # fmt: skip
    for parameter in estimate["parameters"].values():
        assert {"value", "std", "unit", "lower", "upper", "at_bound"} <= set(parameter)
    assert estimate["parameters"]["M"]["unit"] == "kg"
    assert estimate["parameters"]["M"]["lower"] == 30.0
    assert estimate["parameters"]["carriage.viscous.f_v"]["upper"] is None, "no bound is null, not Infinity"
    assert estimate["cost"] > 0
    assert isinstance(estimate["status"], str)
    assert estimate["iterations"] >= 1
    assert set(estimate["seconds"]) >= {"build", "solve"}
    assert (estimate["records"], estimate["provenance"]) == (["first"], "measured")


def test_metrics(tree):
    rows = json.loads((tree / "validate/metrics.json").read_text())
    assert {(row["record"], row["view"]) for row in rows} == {
        (record, view) for record in ("first", "second") for view in ("free_run", "horizon")
    }
    for row in rows:
        assert {"model", "record", "output", "view", "mse", "rmse", "r2", "n", "unit", "provenance"} <= set(
            row
        )
        assert row["output"] == "position"
        assert row["unit"] == "m"
        assert row["rmse"] == pytest.approx(math.sqrt(row["mse"]))
        assert row["horizon"] == (0.3 if row["view"] == "horizon" else None)


def test_fitted_model_comes_back(tree):
    """From the files alone: model and numbers give the very scores that were written."""
    model, estimate = load(tree)
    record = load_record(prepared_records(tree)[1].file)
    again = metrics(free_run(model, estimate.values, record), "gray box")[0]
    rows = json.loads((tree / "validate/metrics.json").read_text())
    written = next(r for r in rows if (r["record"], r["view"]) == ("second", "free_run"))
    assert again.rmse == pytest.approx(written["rmse"], rel=1e-9)
    assert fit_of(tree).estimate.parameters[1].upper == math.inf


def test_predictions_come_back_whole(tree):
    stored = {(s.prediction.record, s.prediction.view): s for s in predictions_in(tree)}
    assert len(stored) == 4
    record = load_record(prepared_records(tree)[0].file)
    prediction = stored["first", "horizon"].prediction
    assert stored["first", "horizon"].horizon == 0.3
    np.testing.assert_array_equal(prediction.measured[:, 0], record.outputs[: len(prediction.time), 0])
    assert prediction.states.shape == (len(prediction.time), 2)
    assert prediction.breaks[:3] == (0, 300, 600)
    rows = json.loads((tree / "validate/metrics.json").read_text())
    written = next(r for r in rows if (r["record"], r["view"]) == ("first", "horizon"))
    assert metrics(prediction, "gray box")[0].rmse == pytest.approx(written["rmse"], rel=1e-12)
    assert {(t.found.record, t.view) for t in residual_tests_in(tree)} == set(stored)
    assert all(len(t.found.autocorrelation) == 21 for t in residual_tests_in(tree))


def test_json_is_strict(tmp_path):
    given = {"a": math.nan, "b": [math.inf, 1.5], "c": np.array([1.0, -np.inf]), "d": np.int64(3), "é": "μ"}
    write_json(tmp_path / "x.json", given)
    text = (tmp_path / "x.json").read_text()
    assert json.loads(text, parse_constant=pytest.fail) == {
        "a": None, "b": [None, 1.5], "c": [1.0, None], "d": 3, "é": "μ"
    }  # fmt: skip
    assert read_json(tmp_path / "x.json")["é"] == "μ"


@pytest.mark.parametrize("content", [b"", b"{", b"\x80\x04", b"[" * 10**5])
def test_what_is_no_json_is_named(tmp_path, content):
    path = tmp_path / "estimate.json"
    path.write_bytes(content)
    with pytest.raises(ValueError, match=r"estimate\.json: (no JSON: .|nested too deep)"):
        read_json(path)


def test_files_are_what_their_schemas_say(tree, fits_schema):
    for name in ("preprocess/records", "fit/estimate", "fit/model", "validate/metrics", "validate/residuals"):
        fits_schema(tree / f"{name}.json")


def test_every_json_of_a_tree_is_strict(tree):
    for path in tree.rglob("*.json"):
        json.loads(path.read_text(), parse_constant=pytest.fail)


@pytest.mark.parametrize(
    ("error", "said"),
    [
        (Diverged("simulation of record first diverged at t = 1 s"), "first diverged at t = 1 s"),
        (TooStiff("needs more than 50 steps a sample"), "record first: needs more than 50 steps a sample"),
    ],
)
def test_a_model_that_cannot_be_simulated_is_a_finding_not_a_crash(
    settings, heard, data, monkeypatch, error, said
):
    """Scores are null, the reason stands beside them, the other views and records are there."""
    from pipelines import validate

    def fails(model, values, record, *rest):
        raise error

    monkeypatch.setattr(validate, "free_run", fails)
    tree = run_stages(settings(), "validate", heard).tree
    rows = json.loads((tree / "validate/metrics.json").read_text())
    free = [row for row in rows if row["view"] == "free_run"]
    assert [row["rmse"] for row in free] == [None, None]
    assert said in free[0]["remark"]
    assert all(row["rmse"] > 0 for row in rows if row["view"] == "horizon")
    assert any(said in line for line in heard.warned)


def test_figures_of_every_kind_are_drawn(settings, heard, data):
    asked = {"validate.records": ["first"], "plot.formats": ["pdf"]}
    tree = run_stages(settings(asked), "run", heard).tree
    names = {p.name for p in (tree / "plot").iterdir()}
    for figure in (
        "first.record", "first.position.comparison", "first.position.error", "first.position.spectrum",
        "first.position.residual.free_run", "first.position.residual.horizon", "first.carriage.friction",
        "position.raincloud", "parameters", "second.record",
    ):  # fmt: skip
        assert f"{figure}.pdf" in names, figure
    assert not any(name.startswith("second.position") for name in names), "was not validated"
