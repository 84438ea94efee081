"""What is fresh is reused, what is stale is made again and says why, and nothing contradicts itself."""

from __future__ import annotations

import json
import os
import time
from importlib.metadata import version
from pathlib import Path

import pytest

from hybridid.records.record import RecordError
from pipelines.runner import run_stages
from pipelines.shared import freshness, imports

OUT = {"out": "tree"}
TREE = Path("tree")


@pytest.fixture
def validated(settings, heard, data, once):
    """The tree of ``settings(OUT)``."""
    once("validated", lambda: run_stages(settings(OUT), "validate", heard))
    heard.said.clear()


@pytest.fixture
def fitted(settings, heard, data, once):
    """The same, not validated."""
    once("fitted", lambda: run_stages(settings(OUT), "fit", heard))
    heard.said.clear()


def stamps(folder: Path) -> dict[str, int]:
    return {p.name: p.stat().st_mtime_ns for p in folder.iterdir()}


def test_second_run_reuses_everything(settings, heard, data):
    first = run_stages(settings(OUT), "validate", heard)
    assert first.ran == ("preprocess", "fit", "validate")
    assert heard.said == [f"{stage}: not made yet" for stage in first.ran]
    assert any("cost" in line for line in heard.works)
    before = {stage: stamps(TREE / stage) for stage in first.ran}
    heard.said.clear()
    second = run_stages(settings(OUT), "validate", heard)
    assert second.ran == ()
    assert second.reused == first.ran
    assert heard.said == [f"{stage}: fresh, reused" for stage in first.ran]
    assert {stage: stamps(TREE / stage) for stage in first.ran} == before


@pytest.mark.parametrize(
    ("change", "stale", "reason"),
    [
        ({"validate.horizon": 0.2}, ("validate",), "validate.horizon changed (0.3 -> 0.2)"),
        ({"effects": ["viscous", "coulomb"]}, ("fit", "validate"), "effects changed"),
        ({"estimator.horizon": 250}, ("fit", "validate"), "estimator.horizon changed (300 -> 250)"),
        ({"parameters.M.lower": 40.0}, ("fit", "validate"), "parameters.M.lower changed (30.0 -> 40.0)"),
        (
            {"preprocess.steps": [{"step": "crop", "stop": 1.0}]},
            ("preprocess", "fit", "validate"),
            "preprocess.steps changed",
        ),
        ({"mlflow.enabled": False}, (), ""),
        ({"case.title": "another title"}, (), ""),
    ],
)
def test_a_change_makes_stale_what_depends_on_it(settings, heard, validated, change, stale, reason):
    assert run_stages(settings({**OUT, **change}), "validate", heard).ran == stale
    if stale:
        assert f"{stale[0]}: stale, {reason}" in "\n".join(heard.said)


def test_a_changed_file_is_noticed(settings, heard, data, fitted, recordings):
    (data / "first.csv").write_text(recordings["first.csv"].replace("t,force,mm", "t,force,mm", 1)[:-60])
    text = (data / "first.csv").read_text()
    (data / "first.csv").write_text(text[: text.rindex("\n") + 1])
    assert run_stages(settings(OUT), "fit", heard).ran == ("preprocess", "fit")
    assert heard.said[0] == "preprocess: stale, record first changed"


def test_touching_a_file_changes_nothing(settings, heard, data):
    run_stages(settings(OUT), "preprocess", heard)
    later = time.time() + 100
    os.utime(data / "first.csv", (later, later))
    assert run_stages(settings(OUT), "preprocess", heard).ran == ()


def test_changed_code_is_noticed(settings, heard, data, monkeypatch):
    run_stages(settings(OUT), "preprocess", heard)
    code = freshness.code_of("pipelines.preprocess")
    monkeypatch.setattr(freshness, "code_of", lambda module: {**code, "hybridid.records": "other"})
    heard.said.clear()
    run_stages(settings(OUT), "preprocess", heard)
    assert heard.said[0] == "preprocess: stale, the code of hybridid.records changed"


def test_another_version_of_a_library_is_noticed(settings, heard, data, monkeypatch):
    run_stages(settings(OUT), "preprocess", heard)
    code = freshness.code_of("pipelines.preprocess")
    monkeypatch.setattr(freshness, "code_of", lambda module: {**code, "numpy": "9.0"})
    heard.said.clear()
    run_stages(settings(OUT), "preprocess", heard)
    assert heard.said[0] == f"preprocess: stale, numpy changed ({version('numpy')} -> 9.0)"


def test_a_changed_plant_is_noticed_where_the_config_names_it(settings, heard, validated, monkeypatch):
    """No stage imports a plant: the config names it."""
    files = imports.files_of("hybridid.plants.emps")
    monkeypatch.setattr(imports, "files_of", lambda module: [*files, "hybridid/naming.py"])
    assert run_stages(settings(OUT), "validate", heard).ran == ("fit", "validate")
    assert heard.said[1] == "fit: stale, the code of hybridid.plants.emps changed"


def test_a_changed_rig_makes_its_records_stale(settings, heard, data, monkeypatch):
    simulated = {**OUT, "data": "simulated"}
    run_stages(settings(simulated), "preprocess", heard)
    files = imports.files_of("hybridid.rigs.emps")
    monkeypatch.setattr(imports, "files_of", lambda module: [*files, "hybridid/declarations.py"])
    heard.said.clear()
    run_stages(settings(simulated), "preprocess", heard)
    assert "preprocess: stale, the code of hybridid.rigs.emps changed" in heard.said


def test_results_of_an_earlier_fit_do_not_stay_beside_a_new_one(settings, heard, validated):
    run_stages(settings({**OUT, "effects": ["viscous"]}), "fit", heard)
    assert not (TREE / "validate").exists()
    assert "validate: removed" in heard.said[-1]


def test_a_remade_stage_with_the_same_result_leaves_the_rest_fresh(settings, heard, fitted):
    (TREE / "preprocess" / "stage.json").unlink()
    assert run_stages(settings(OUT), "fit", heard).ran == ("preprocess",)


def test_a_fit_made_again_with_the_same_result_leaves_the_rest_fresh(settings, heard, validated):
    """Only the seconds that it took are others."""
    estimate = TREE / "fit" / "estimate.json"
    before = json.loads(estimate.read_text())
    (TREE / "fit" / "stage.json").unlink()
    assert run_stages(settings(OUT), "validate", heard).ran == ("fit",)
    after = json.loads(estimate.read_text())
    assert after["seconds"] != before["seconds"]
    assert after["parameters"] == before["parameters"]
    assert (TREE / "validate").exists()


def test_force_makes_again_what_is_fresh(settings, heard, data):
    run_stages(settings(OUT), "preprocess", heard)
    heard.said.clear()
    assert run_stages(settings({**OUT, "force": True}), "preprocess", heard).ran == ("preprocess",)
    assert heard.said == ["preprocess: fresh, made again (force)"]


def test_a_stage_that_fails_leaves_what_was_there(settings, heard, data, fitted):
    before = (TREE / "fit" / "estimate.json").read_text()
    text = (data / "first.csv").read_text().splitlines()
    text[50] = "0.049,nan,1.0"
    (data / "first.csv").write_text("\n".join(text) + "\n")
    with pytest.raises(RecordError, match="NaN"):
        run_stages(settings(OUT), "fit", heard)
    assert (TREE / "fit" / "estimate.json").read_text() == before
    assert sorted(p.name for p in TREE.iterdir() if p.name != ".lock") == ["config.yaml", "fit", "preprocess"]


def test_left_overs_of_a_killed_process_are_removed(settings, heard, data):
    (TREE / ".unfinished-abc" / "fit").mkdir(parents=True)
    run_stages(settings(OUT), "preprocess", heard)
    assert not (TREE / ".unfinished-abc").exists()


def test_receipt_says_what_it_was_made_from(settings, heard, data):
    run_stages(settings(OUT), "preprocess", heard)
    receipt = json.loads((TREE / "preprocess" / "stage.json").read_text())["fingerprint"]
    assert receipt["inputs"]["record first"].startswith("measured ")
    assert receipt["config"]["signals.inputs.force.column"] == "force"
    assert len(receipt["code"]["hybridid.records"]) == 64
    assert receipt["code"]["numpy"] == version("numpy")
