"""``hybridid trace`` on the virtual carriage, which hides what its case does not declare."""

from __future__ import annotations

import json
import re
import traceback
from itertools import groupby
from pathlib import Path

import pytest
from jsonschema import Draft202012Validator

from hybridid.effects.library import effect_named
from hybridid.plain import plain
from hybridid.records.store import load_record
from hybridid.trace.mapper import serial, silent
from hybridid.trace.run import trace
from pipelines.shared.fitted import load
from pipelines.shared.kept_results import kept_results

HIDDEN = 73.718  # N s/m: f_v of the worn screw, one way less the other
FEW = (
    "trace.effects=[asymmetric_viscous, cubic_stiffness]",
    "trace.horizon=0.5",
    "trace.processes=1",
    "trace.variables=[velocity]",
)
RECORDS = ("identification", "validation")
OF_THE_COMMAND = ("case", "processes", "fitted_records", "commands", "further_traces")
KEYS = {"verdict", "accepted", "rejected", "before", "after", "noise_floor", "seconds"}


@pytest.fixture(scope="module")
def tree(tmp_path_factory) -> Path:
    return tmp_path_factory.mktemp("trace") / "tree"


@pytest.fixture
def traced(say, tree, quick):
    """What was said, and ``trace.json``; traced once."""
    said = say("trace", *quick, "rig.duration=6", *FEW, f"out={tree}")
    assert said.code == 0, said.err
    return said, json.loads((tree / "trace/trace.json").read_text())


def test_the_file_is_what_its_schema_says(traced):
    schema = Path(__file__).parents[2] / "docs/schemas/trace.schema.json"
    Draft202012Validator(json.loads(schema.read_text())).validate(traced[1])


def test_the_hidden_effect_is_named_with_its_size(traced):
    _, data = traced
    assert data.keys() >= KEYS
    assert data["verdict"] == "effect_found"
    assert [(a["effect"], a["port"], a["class"]) for a in data["accepted"]] == [
        ("asymmetric_viscous", "carriage", ["asymmetric_viscous"])
    ]
    found = data["accepted"][0]["parameters"]["df_v"]
    assert found["value"] == pytest.approx(HIDDEN, rel=0.05)
    assert {r["effect"] for r in data["rejected"]} == {"cubic_stiffness"}


def test_before_and_after_both_records_both_views_with_and_without_network(traced):
    _, data = traced
    for rows in (data["before"], data["after"]):
        seen = {(row["record"], row["view"], row["network"]) for row in rows}
        assert len(seen) == 2 * 2 * 2
        assert {row["provenance"] for row in rows} == {"simulated"}
    errors = [
        next(r["rmse"] for r in data[when] if r["view"] == "horizon" and r["role"] == "held out")
        for when in ("before", "after")
    ]
    assert errors[1] < 0.2 * errors[0]


def test_terminal_and_page_say_it_and_that_it_is_simulated(traced, tree):
    said, data = traced
    page = (tree / "trace/report.html").read_text()
    markdown = (tree / "trace/report.md").read_text()
    for text in (page, markdown):
        assert "simulated" in text
        assert "What is left" in text
    assert data["sentence"] in markdown
    assert "effect found" in said.out
    assert "asymmetric_viscous" in said.out


def test_what_a_network_still_takes_is_called_by_its_name(traced, tree):
    """The rig's friction truly sticks, the model's is smoothed: a learned effort finds that, and says so."""
    _, data = traced
    left = (tree / "trace/report.md").read_text().partition("## What is left")[2]
    worth = [c for c in data["ceilings"]["after"] if c["gain"] >= data["rules"]["worth"]]
    assert worth
    assert ("No learned effort is shown to take" in left) == (not worth)
    assert ("does not survive other ways of solving the equations" in left) == (
        not data["remains"] and not data["completeness"]["complete"]
    )


def test_the_augmented_model_is_taken_up_as_any_other(traced, say, tree, quick, tmp_path):
    model = tree / "trace/model.json"
    said = say("validate", *quick, "rig.duration=6", f"model={model}", f"out={tmp_path / 'after'}")
    assert said.code == 0, said.err
    rows = json.loads((tmp_path / "after/validate/metrics.json").read_text())
    assert all(row["r2"] > 0.9999 for row in rows if row["view"] == "horizon"), rows


def test_parameters_typed_beside_a_model_count_and_effects_do_not_fit(traced, say, tree, quick, tmp_path):
    model, out = f"model={tree / 'trace/model.json'}", tmp_path / "narrow"
    said = say("preprocess", *quick, model, "parameters.carriage.epsilon.guess=1e-4", f"out={out}")
    assert said.code == 0, said.err
    assert "guess: 0.0001" in (out / "config.yaml").read_text()
    refused = say("preprocess", *quick, model, "effects=[viscous]", f"out={tmp_path / 'other'}")
    assert refused.code != 0
    assert "brings its own effects: leave out effects=[viscous], or model=" in refused.err


def test_a_notebook_gets_what_the_command_writes_even_if_it_goes_on(traced, tree):
    """After a time limit that left something out, and an interruption, the same records, model and start give
    the same numbers; only the seconds differ."""
    _, data = traced
    model, estimate = load(tree)
    first, second = (load_record(tree / f"preprocess/{name}.parquet") for name in RECORDS)
    tried = [effect_named(name) for name in ("asymmetric_viscous", "cubic_stiffness")]
    said = []

    def once_more(report, limit):
        with kept_results("this test", False, said.append) as keep:
            return trace(
                model, [first], [second],
                horizon=0.5, effects=tried, variables=("velocity",), start=estimate.values,
                time_limit=limit, mapper=keep(serial), report=report,
            )  # fmt: skip

    def interrupted(stage, done, of, what):
        if stage == "before and after":
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        once_more(interrupted, 1e-3)
    found = once_more(silent, None)
    assert re.fullmatch(r"goes on where it was interrupted: \d{2,} results are kept", said[0])
    written = {key: value for key, value in data.items() if key not in OF_THE_COMMAND}
    assert without_seconds(plain(found)) == without_seconds(written)


def test_what_was_written_reads_back_as_it_was(traced, tree):
    """The terminal prints what it reads: nothing may be lost on the way."""
    from pipelines.shared.traced import trace_of

    _, data = traced
    assert plain(trace_of(tree)) == data


def test_each_module_is_entered_once_before_the_search(say, quick, tmp_path, monkeypatch):
    """The calls from the terminal down to the search are those that CONTRIBUTING.md lists."""

    class Begun(BaseException):
        pass

    def modules_on_the_way() -> list[str]:
        names = [frame.f_globals["__name__"] for frame, _ in traceback.walk_stack(None)]
        own = [name for name in names if name.split(".")[0] in ("hybridid", "pipelines", "hybridid_cli")]
        return [name for name, _ in groupby(reversed(own))]

    def search(*given):
        raise Begun(modules_on_the_way())

    monkeypatch.setattr("hybridid.trace.verdict.search", search)
    with pytest.raises(Begun) as begun:
        say("trace", *quick, "trace.horizon=0.1", *FEW[:1], "trace.processes=1", f"out={tmp_path / 'tree'}")
    text = (Path(__file__).parents[2] / "CONTRIBUTING.md").read_text().partition("## From")[2]
    listed = re.findall(r"^((?:hybridid_cli|pipelines|hybridid)\.[\w.]+)  ", text, flags=re.MULTILINE)
    (entered,) = begun.value.args
    assert [*entered, "hybridid.trace.search.search"] == listed
    assert len(set(listed)) == len(listed)


def without_seconds(value):
    if isinstance(value, dict):
        return {key: without_seconds(below) for key, below in value.items() if key != "seconds"}
    return [without_seconds(item) for item in value] if isinstance(value, list) else value


@pytest.mark.parametrize(
    ("wrong", "named"),
    [
        ("trace.effects=[friktion]", "friktion"),
        ("trace.ports=[gearbox]", "gearbox"),
        ("trace.variables=[velocty]", "did you mean 'velocity'?"),
        ("trace.worth=-1", "trace.worth"),
    ],
)
def test_wrong_requests_in_one_line(say, quick, tmp_path, wrong, named):
    said = say("trace", *quick, wrong, f"out={tmp_path / 'tree'}")
    assert said.code != 0
    assert named in said.complaint
    assert not (tmp_path / "tree/trace").exists()
