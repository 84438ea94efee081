"""``records.NAME.parameters``: a mass that was changed between two recordings."""

from __future__ import annotations

import json
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from hybridid.rigs.emps import DEFAULT, EMPSRig
from pipelines.runner import run_stages
from pipelines.shared.errors import ConfigError
from pipelines.shared.fitted import fit_of, load
from pipelines.shared.modelling import model_of
from pipelines.shared.prepared import prepared_records
from pipelines.trace.request import request_of

LIGHT, HEAVY = 60.0, 130.0
BOTH = {
    "parameters": {},
    "effects": ["viscous", "coulomb", "asymmetric_viscous"],
    "records.first.parameters": {"M": LIGHT},
    "records.second.parameters": {"M": HEAVY},
    "fit.records": None,
}


@cache
def texts():
    """The files of both, simulated once."""
    made = {}
    for name, run, mass in (("first.csv", "identification", LIGHT), ("second.csv", "validation", HEAVY)):
        rig = EMPSRig(replace(DEFAULT, truth=replace(DEFAULT.truth, M=mass)))
        record = rig.record(run, duration=1.2)
        columns = np.column_stack([record.time, record.inputs[:, 0], 1e3 * record.outputs[:, 0]])
        rows = "\n".join(",".join(f"{value:.12g}" for value in row) for row in columns)
        made[name] = f"t,force,mm\n{rows}\n"
    return made


@pytest.fixture
def two_masses(data):
    """The data root; the first recording is of a light carriage, the second of a heavy one."""
    for name, text in texts().items():
        (data / name).write_text(text)
    return data


def test_each_record_has_its_own_mass(settings, two_masses, heard):
    tree = run_stages(settings(BOTH), "validate", heard).tree
    found = fit_of(tree).estimate
    assert "M" not in found.values
    assert found.values["carriage.viscous.f_v"] == pytest.approx(DEFAULT.truth.f_v, rel=0.05)
    scores = json.loads((tree / "validate/metrics.json").read_text())
    assert {row["record"] for row in scores} == {"first", "second"}
    swapped = {**BOTH, "records.first.parameters": {"M": HEAVY}, "records.second.parameters": {"M": LIGHT}}
    wrong = fit_of(run_stages(settings({**swapped, "out": "swapped"}), "fit", heard).tree).estimate
    assert wrong.cost > 100 * found.cost
    assert not any("constant" in line for line in heard.warned)


def test_a_fit_can_be_read_again_without_its_records(settings, two_masses, heard):
    tree = run_stages(settings(BOTH), "fit", heard).tree
    model, estimate = load(tree)
    assert [signal.name for signal in model.inputs] == ["force", "M"]
    assert [signal.name for signal in model.signals] == ["force"]
    assert "M" not in {p.name for p in model.parameters}
    assert estimate.values == fit_of(tree).estimate.values
    first = prepared_records(tree)[0]
    assert [(signal.name, signal.unit) for signal in first.inputs] == [("force", "N"), ("M", "kg")]


def test_a_model_file_keeps_what_the_records_give(settings, two_masses, heard):
    tree = run_stages(settings(BOTH), "fit", heard).tree
    saved = json.loads((tree / "fit/model.json").read_text())
    assert saved["config"]["parameters"]["M"] == {"by_record": True}
    assert model_of(settings({**BOTH, "parameters": saved["config"]["parameters"]})).by_record == ("M",)


@pytest.mark.usefixtures("no_figures")
def test_a_trace_takes_each_record_s_own(settings, two_masses, heard):
    chosen = {
        **BOTH,
        "effects": ["viscous", "coulomb"],
        "trace": {
            "effects": ["asymmetric_viscous"],
            "processes": 1,
            "laws": False,
            "horizon": 0.3,
            "variables": ["velocity"],
        },
        "fit.records": ["identification"],
    }
    request_of(settings(chosen))
    tree = run_stages(settings(chosen), "trace", heard).tree
    found = json.loads((tree / "trace/trace.json").read_text())
    assert [entry["effect"] for entry in found["accepted"]] == ["asymmetric_viscous"]


def test_recordings_that_disagree_are_told_before_the_search(settings, two_masses, heard, monkeypatch):
    class Begun(Exception):
        pass

    def begin(*given):
        raise Begun

    monkeypatch.setattr("pipelines.trace.stage.traced", begin)
    records = {name: {"files": f"{name}.csv", "role": "identification"} for name in ("first", "second")}
    one_mass = {"rig": None, "records": records, "parameters": {}, "fit.records": None}
    with pytest.raises(Begun):
        run_stages(settings(one_mass), "trace", heard)
    (said,) = [line for line in heard.warned if line.startswith("the recordings disagree")]
    assert "M is 60" in said
    assert "parameters.M.by=record" in said


def test_another_value_makes_the_results_stale(settings, two_masses, heard):
    same = {**BOTH, "out": "tree"}
    run_stages(settings(same), "fit", heard)
    assert run_stages(settings(same), "fit", heard).ran == ()
    changed = run_stages(settings({**same, "records.second.parameters": {"M": 131.0}}), "fit", heard)
    assert changed.ran == ("preprocess", "fit")


@pytest.mark.parametrize(
    ("changes", "line"),
    [
        (
            {"records.second.parameters": {}},
            "records.second.parameters: M is missing, which other records give",
        ),
        ({"records.first.parameters": {"M": "heavy"}}, "records.first.parameters.M is 'heavy'"),
        ({"records.first.parameters": {"M": float("nan")}}, "must be a finite number"),
        ({"records.first.parameters": 95}, "records.first.parameters is 95: give names with numbers"),
        ({"records.first.parameters": {"m": 1}, "records.second.parameters": {"m": 1}}, "did you mean 'M'?"),
        ({"parameters": {"M": {"guess": 90.0}}}, "parameters.M is set, but every record gives M"),
    ],
)
def test_what_cannot_be_is_one_line(changes, line, settings, two_masses, heard):
    with pytest.raises(ConfigError) as refused:
        run_stages(settings({**BOTH, **changes}), "fit", heard)
    assert line in str(refused.value)
    assert len(str(refused.value).splitlines()) == 1
