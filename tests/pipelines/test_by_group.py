"""``parameters.NAME.by``: friction that changed between recordings, estimated for each of them."""

from __future__ import annotations

import json
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
import yaml

from hybridid.rigs.emps import DEFAULT, EMPSRig
from pipelines.runner import run_stages
from pipelines.shared.augmented import taken_up
from pipelines.shared.errors import ConfigError
from pipelines.shared.fitted import fit_of, load
from pipelines.shared.modelling import model_of
from pipelines.shared.prepared import prepared_records
from pipelines.tracking.metrics import metrics_of

F_C = "carriage.coulomb.f_c"
LOW, HIGH = 20.0, 21.0
RUNS = {
    "first": ("identification", LOW),
    "second": ("validation", HIGH),
    "third": ("validation", LOW),
    "fourth": ("identification", HIGH),
}
RECORDS = {name: {"files": f"{name}.csv", "role": "identification"} for name in RUNS}
GROUPS = {"cold": ["first", "third"], "warm": ["second", "fourth"]}


def by(setting, **more):
    """The settings of a case with four records whose Coulomb friction differs ``by`` something."""
    changes = {
        "records": RECORDS,
        "parameters": {F_C: {"by": setting, "lower": 0.0, "upper": 60.0}},
        "fit.records": None,
        "rig": None,
    }
    return {**changes, **{key.replace("__", "."): value for key, value in more.items()}}


@cache
def texts():
    """The files of four recordings, two of them of a carriage with more friction; simulated once."""
    made = {}
    for seed, (name, (run, f_c)) in enumerate(RUNS.items()):
        rig = EMPSRig(replace(DEFAULT, truth=replace(DEFAULT.truth, f_c=f_c)))
        record = rig.record(run, seed=seed, duration=1.2)
        columns = np.column_stack([record.time, record.inputs[:, 0], 1e3 * record.outputs[:, 0]])
        rows = "\n".join(",".join(f"{value:.12g}" for value in row) for row in columns)
        made[f"{name}.csv"] = f"t,force,mm\n{rows}\n"
    return made


@pytest.fixture
def cold_and_warm(data):
    """The data root with these recordings."""
    for name, text in texts().items():
        (data / name).write_text(text)
    return data


def test_two_groups_are_told_apart(settings, cold_and_warm, heard, fits_schema):
    tree = run_stages(settings(by(GROUPS)), "validate", heard).tree
    found = fit_of(tree).estimate
    assert F_C not in found.values
    cold, warm = (found.values[f"{F_C}[{name}]"] for name in GROUPS)
    assert warm - cold == pytest.approx(HIGH - LOW, abs=0.1)
    (one,) = found.differences
    assert (one.parameter, one.groups) == (F_C, ("cold", "warm"))
    assert one.test.p_value < 1e-3
    fits_schema(tree / "fit/estimate.json")
    stored = json.loads((tree / "fit/estimate.json").read_text())
    assert stored["differences"][F_C]["p_value"] == one.test.p_value
    logged = metrics_of(tree, ["fit"])
    assert logged[f"parameter.{F_C}.cold"] == cold
    assert logged[f"spread.{F_C}"] == one.spread
    assert not heard.warned
    shared = fit_of(run_stages(settings({**by(None), "out": "shared"}), "fit", heard).tree).estimate
    assert shared.cost > 10 * found.cost


def test_a_group_holds_for_records_that_are_not_fitted(settings, cold_and_warm, heard):
    tree = run_stages(settings(by(GROUPS, fit__records=["first", "second"])), "validate", heard).tree
    assert not heard.warned
    record = {one.name: one for one in prepared_records(tree)}["fourth"]
    assert [signal.name for signal in record.inputs] == ["force", f"{F_C}[cold]", f"{F_C}[warm]"]
    scores = {
        (r["record"], r["view"]): r["rmse"] for r in json.loads((tree / "validate/metrics.json").read_text())
    }
    assert scores["fourth", "horizon"] < 3 * scores["first", "horizon"]


def test_a_record_that_is_not_fitted_takes_the_mean_of_the_others(settings, cold_and_warm, heard):
    chosen = settings(by("record", fit__records=["first", "second"]))
    tree = run_stages(chosen, "validate", heard).tree
    estimate = fit_of(tree).estimate
    assert estimate.differences[0].groups == ("first", "second")
    said = [line for line in heard.warned if F_C in line]
    assert [line.partition(" is not fitted")[0] for line in said] == ["record third", "record fourth"]
    assert f"the mean of first and second is taken, {estimate.differences[0].mean:.4g} N" in said[0]


def test_a_fit_can_be_read_again_and_taken_up(settings, cold_and_warm, heard):
    chosen = by("record", fit__records=["first", "second"])
    tree = run_stages(settings(chosen), "fit", heard).tree
    model, estimate = load(tree)
    assert model.groups == {F_C: ("first", "second")}
    assert set(estimate.values) == {p.name for p in model.parameters}
    again = settings(chosen)
    again = replace(again, config=taken_up({**again.config, "model": str(tree / "fit/model.json")}))
    assert model_of(again).groups == model.groups
    assert model_of(again).parameters == model.parameters


def test_other_groups_make_the_results_stale_and_other_bounds_only_the_fit(settings, cold_and_warm, heard):
    def said(changes):
        heard.said.clear()
        run_stages(settings({**changes, "out": "tree"}), "fit", heard)
        return heard.said

    others = {"cold": ["first"], "warm": ["second", "third", "fourth"]}
    said(by(GROUPS))
    assert said(by(GROUPS)) == ["preprocess: fresh, reused", "fit: fresh, reused"]
    assert said(by(others))[0] == "preprocess: stale, groups of record third changed"
    wider = by(others)
    wider["parameters"][F_C]["upper"] = 70.0
    assert said(wider)[0] == "preprocess: fresh, reused"
    assert heard.said[1].startswith("fit: stale, parameters")


@pytest.mark.usefixtures("no_figures")
def test_a_trace_judges_with_the_values_of_the_groups(settings, cold_and_warm, heard):
    chosen = by(GROUPS, fit__records=["first", "second"])
    chosen |= {
        "effects": ["viscous", "coulomb"],
        "trace": {
            "effects": ["offset"],
            "records": ["first", "second"],
            "held_out": ["third", "fourth"],
            "processes": 1,
            "laws": False,
            "horizon": 0.3,
            "variables": ["velocity"],
        },
    }
    tree = run_stages(settings(chosen), "trace", heard).tree
    found = json.loads((tree / "trace/trace.json").read_text())
    assert [entry["effect"] for entry in found["accepted"]] == ["offset"]
    kept = json.loads((tree / "trace/model.json").read_text())["config"]["parameters"]
    assert kept["carriage"]["coulomb"]["f_c"]["by"] == GROUPS


def test_a_trace_fits_a_record_of_each_group(settings, cold_and_warm, heard):
    chosen = by(GROUPS) | {"trace": {"effects": ["stribeck"], "records": ["first"], "held_out": ["second"]}}
    with pytest.raises(ConfigError, match=r"of group warm no record is fitted.* trace.records chooses first"):
        run_stages(settings(chosen), "trace", heard)


def test_groups_of_an_effect_that_is_not_selected_are_not_there(settings, cold_and_warm, heard):
    model = model_of(settings(by(GROUPS, effects=["viscous", "offset"])))
    assert not model.groups
    assert [signal.name for signal in model.inputs] == ["force"]


def test_names_of_groups_may_have_dots(settings, cold_and_warm):
    groups = {"20.5 °C": ["first", "third"], "31 °C": ["second", "fourth"]}
    assert model_of(settings(by(groups))).groups == {F_C: tuple(groups)}
    text = yaml.safe_dump({"carriage": {"coulomb": {"f_c.by": groups}}})
    assert model_of(settings(by(None, parameters=yaml.safe_load(text)))).groups == {F_C: tuple(groups)}


WHERE = f"parameters.{F_C}.by"


@pytest.mark.parametrize(
    ("changes", "line"),
    [
        (by("recrd"), f"{WHERE} is 'recrd': give record, or groups of records"),
        (by({"cold": 3}), f"{WHERE}.cold is 3: give a list of records"),
        (by({**GROUPS, "cold": ["frist"]}), f"unknown record in {WHERE}: 'frist': did you mean 'first'?"),
        (
            by({**GROUPS, "warm": ["first", "second", "fourth"]}),
            "record first is in group cold and in group warm",
        ),
        (by({"cold": ["first"], "warm": ["second", "fourth"]}), "no group has record third"),
        (by(GROUPS, fit__records=["first"]), "of group warm no record is fitted"),
        (by("record", fit__records=["first"]), "first is the only group, so nothing can differ"),
        (by(None, parameters={"carriage.coulomb.fc": {"by": "record"}}), f"did you mean '{F_C}'?"),
        (by(None, parameters={F_C: {"by": "record", "fixed": 20.0}}), f"{F_C} is known, 20 N"),
        (by(None, parameters={F_C: {"buy": "record"}}), "did you mean 'by'?"),
        (by(None, parameters={"carriage.epsilon": {"by": "record"}}), "unknown parameter that differs by"),
        (
            by(
                None,
                parameters={"M": {"by": "record"}},
                records={name: {**one, "parameters": {"M": 95.0}} for name, one in RECORDS.items()},
            ),
            "parameters.M is set, but every record gives M",
        ),
    ],
)
def test_what_cannot_be_is_one_line(changes, line, settings, cold_and_warm, heard):
    with pytest.raises(ConfigError) as refused:
        run_stages(settings(changes), "fit", heard)
    assert line in str(refused.value)
    assert len(str(refused.value).splitlines()) == 1


def by_recording(**section):
    """The settings of a trace that asks which parameters differ by recording."""
    asked = {"by_recording": True, "effects": ["stribeck"], "processes": 1, "laws": False, "horizon": 0.1}
    asked["variables"] = ["velocity"]
    changes = {"records": RECORDS, "parameters": {}, "rig": None, "fit.records": None}
    return {**changes, "trace": {"records": None, "held_out": None, **asked, **section}}


@pytest.mark.usefixtures("no_figures")
def test_a_trace_names_what_differs_by_recording(settings, cold_and_warm, heard, fits_schema):
    tree = run_stages(settings(by_recording()), "trace", heard).tree
    fits_schema(tree / "trace/trace.json")
    found = json.loads((tree / "trace/trace.json").read_text())
    (one,) = (one for one in found["by_recording"] if one["status"] == "passed")
    assert one["parameter"] == F_C
    values = {name: value["value"] for name, value in one["values"].items()}
    low = values["first"]
    assert {name: value - low for name, value in values.items()} == pytest.approx(
        {name: f_c - LOW for name, (_, f_c) in RUNS.items()}, abs=0.15
    )
    assert f"{F_C} differs by recording, " in found["sentence"]
    assert found["verdict"] not in ("nothing_missing", "undecided")
    assert "What differs by recording" in (tree / "trace/report.html").read_text()


@pytest.mark.parametrize(
    ("section", "line"),
    [
        (
            {"records": ["first", "fourth"], "held_out": ["second", "third"]},
            "trace.by_recording: no fit knows a parameter's value in second and third, held out as a whole",
        ),
        ({"records": ["first"]}, "trace.by_recording: trace.records chooses first alone"),
    ],
)
def test_what_cannot_judge_a_difference_is_refused(section, line, settings, cold_and_warm, heard):
    with pytest.raises(ConfigError) as refused:
        run_stages(settings(by_recording(**section)), "trace", heard)
    assert line in str(refused.value)
    assert len(str(refused.value).splitlines()) == 1
