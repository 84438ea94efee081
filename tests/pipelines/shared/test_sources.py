"""Which records a case gets: measured where they are found, else simulated and called so."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from hybridid.records.sources import RecordNotFoundError
from pipelines import fit
from pipelines.runner import run_stages
from pipelines.shared.errors import ConfigError
from pipelines.shared.predictions import predictions_in
from pipelines.shared.sources import Measured, Simulated, chosen, sources_of


def test_measured_records_are_taken_where_found(settings, data):
    sources = sources_of(settings())
    assert [type(s) for s in sources.found] == [Measured, Measured]
    assert [s.role for s in sources.found] == ["identification", "validation"]
    assert sources.remarks == ()
    assert not sources.simulated


def test_rig_stands_in_and_says_so(settings, own_folder):
    sources = sources_of(settings({"paths.data": None}))
    assert [type(s) for s in sources.found] == [Simulated, Simulated]
    assert "first.csv not found" in sources.remarks[0]
    assert "SIMULATED" in sources.remarks[1]
    assert sources.found[0].record().name == "first"
    assert sources.found[0].record().simulated


def test_simulated_on_request_even_beside_measured(settings, data):
    assert sources_of(settings({"data": "simulated"})).simulated


def test_measured_and_simulated_are_never_mixed(settings, data):
    (data / "second.csv").unlink()
    sources = sources_of(settings())
    assert [s.name for s in sources.found] == ["first"]
    assert not sources.simulated
    assert "second.csv not found" in sources.remarks[0]
    with pytest.raises(RecordNotFoundError, match=r"second\.csv"):
        sources_of(settings({"data": "measured"}))


def test_no_record_and_no_rig(settings, own_folder):
    with pytest.raises(RecordNotFoundError, match=r"first\.csv"):
        sources_of(settings({"rig": None, "paths.data": None}))
    with pytest.raises(ConfigError, match="has no virtual rig"):
        sources_of(settings({"rig": None, "data": "simulated"}))


def test_a_fitted_record_that_is_not_found_is_told_where_a_rig_would_stand_in(settings, data):
    (data / "second.csv").unlink()
    with pytest.raises(ConfigError, match=r"unknown record in fit\.records: 'second'.*second\.csv not found"):
        fit.check(settings({"fit.records": ["second"]}))


def test_a_case_without_a_rig_needs_all_its_records(settings, data):
    """A name that is mistyped must not leave a record out unseen."""
    (data / "second.csv").unlink()
    with pytest.raises(RecordNotFoundError, match=r"^record second: .*second\.csv"):
        sources_of(settings({"rig": None}))


@pytest.mark.parametrize(
    ("change", "line"),
    [
        ({"records.first.role": "training"}, "unknown role"),
        ({"records.first.flies": "x"}, "did you mean 'files'"),
        ({"signals.inputs.force.hold": "zho"}, "zoh"),
        ({"rig.sead": 1, "data": "simulated"}, "did you mean 'seed'"),
        ({"records.first.run": "identificaton", "data": "simulated"}, "did you mean 'identification'"),
        ({"records": []}, "records must map names"),
        ({"signals": 3}, "signals is 3: give time, inputs and outputs"),
        ({"records.first.steps": 3}, r"records\.first\.steps is 3: give a list of steps"),
        ({"records": {"../evil": {"files": "a.csv", "role": "identification"}}}, "files are named after it"),
        ({"records": {"": {"files": "a.csv", "role": "identification"}}}, "files are named after it"),
        ({"records": {"x" * 300: {"files": "a.csv", "role": "identification"}}}, "at most 100 bytes"),
    ],
)
def test_wrong_config_is_one_line(settings, data, change, line):
    with pytest.raises(ConfigError, match=line) as caught:
        sources_of(settings(change))
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("change", "line"),
    [
        ({"signals.inputs.force.hold": "foo"}, "hold is 'foo': did you mean 'foh'"),
        ({"signals.inputs.force.unit": 3}, "unit is 3: expected text"),
        ({"signals.inputs.force.scale": 0}, "scale is 0"),
        ({"signals.inputs.force.column": 3}, "column is 3: expected text"),
        ({"signals.inputs.force.colum": "f"}, "did you mean 'column'"),
        ({"signals.time": {"unit": "year", "column": "t"}}, "unknown unit 'year'"),
        ({"signals.resample": 0}, "dt is 0 s"),
        ({"records.first.flies": "x"}, "did you mean 'files'"),
        ({"signals.inputs.force.unit": "V"}, r"inputs force \[V\], rig emps simulates force \[N\]"),
        ({"signals.outputs": {"angle": {"column": "mm", "unit": "rad"}}}, r"outputs angle \[rad\], rig"),
        ({"signals": {}}, "key 'time' is missing"),
    ],
)
@pytest.mark.parametrize("data", ["simulated", "auto"])
def test_a_rehearsal_refuses_what_the_real_run_would(settings, own_folder, change, line, data):
    with pytest.raises(ConfigError, match=line):
        sources_of(settings({"data": data, "paths.data": None, **change}))


def test_a_case_that_is_only_simulated_needs_no_signals(settings, own_folder):
    records = {"first": {"role": "identification", "run": "identification"}}
    only = settings({"data": "simulated", "records": records, "signals": None})
    assert [source.name for source in sources_of(only).found] == ["first"]


def test_chosen_by_role_or_name(settings, data):
    found = sources_of(settings()).found
    assert [s.name for s in chosen(found, None, "k")] == ["first", "second"]
    assert [s.name for s in chosen(found, ["validation"], "k")] == ["second"]
    assert [s.name for s in chosen(found, ["first", "validation"], "k")] == ["first", "second"]
    with pytest.raises(ConfigError, match=r"record in fit\.records: 'frist'.*'first'"):
        chosen(found, ["frist"], "fit.records")


def test_every_file_made_from_simulated_records_says_so(settings, heard):
    tree = run_stages(settings({"paths.data": None}), "validate", heard).tree
    assert tree.name.endswith("-simulated")
    assert any("SIMULATED" in line for line in heard.warned)
    for name in ("preprocess/records.json", "fit/estimate.json", "fit/model.json", "validate/metrics.json"):
        assert '"simulated"' in (tree / name).read_text(), name
    assert {s.prediction.provenance for s in predictions_in(tree)} == {"simulated"}
    for path in Path(tree).rglob("*.json"):
        assert '"measured"' not in path.read_text(), path


def test_the_warning_is_repeated_when_results_are_reused(settings, heard):
    run_stages(settings({"paths.data": None}), "preprocess", heard)
    heard.warned.clear()
    run_stages(settings({"paths.data": None}), "preprocess", heard)
    assert any("SIMULATED" in line for line in heard.warned)


def test_fitted_records_are_a_choice(settings, heard, data):
    tree = run_stages(settings({"fit.records": ["validation"]}), "fit", heard).tree
    assert json.loads((tree / "fit/estimate.json").read_text())["records"] == ["second"]
