"""JSON recordings: three shapes give columns under their names, all others one clear line."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from hybridid.records.mapping import build_record, record_map
from hybridid.records.readers import read_columns
from hybridid.records.record import RecordError

SAMPLES = [{"t": 0.01 * k, "q": 0.1 * k, "on": k > 2} for k in range(60)]


def written(folder: Path, content: Any) -> Path:
    path = folder / "run.json"
    path.write_text(content if isinstance(content, str) else json.dumps(content))
    return path


def test_samples_beside_constants(tmp_path):
    columns = read_columns(written(tmp_path, {"kp": 400, "motor": "xl330", "log": SAMPLES}))
    assert list(columns) == ["t", "q", "on", "kp"]
    np.testing.assert_allclose(columns["q"], 0.1 * np.arange(60))
    assert columns["on"].tolist() == [0.0] * 3 + [1.0] * 57
    assert columns["kp"].tolist() == [400.0] * 60
    with pytest.raises(RecordError, match="'motor' cannot be a signal: it holds the text 'xl330', no number"):
        columns["motor"]


@pytest.mark.parametrize(
    "content",
    [
        SAMPLES,
        {"t": [s["t"] for s in SAMPLES], "q": [s["q"] for s in SAMPLES], "on": [s["on"] for s in SAMPLES]},
    ],
    ids=["a list of samples", "lists"],
)
def test_the_other_two_shapes_give_the_same(tmp_path, content):
    whole = read_columns(written(tmp_path, {"log": SAMPLES}))
    columns = read_columns(written(tmp_path, content))
    assert {name: column.tolist() for name, column in columns.items()} == {
        name: column.tolist() for name, column in whole.items()
    }


def test_a_missing_value_is_no_number(tmp_path):
    columns = read_columns(written(tmp_path, [{"q": 1.0}, {"q": None}, {"q": 2}]))
    np.testing.assert_array_equal(columns["q"], [1.0, np.nan, 2.0])


@pytest.mark.parametrize(
    ("content", "said"),
    [
        ("{", "not a readable .json file"),
        ("3", "it holds the value 3"),
        ('"text"', "it holds the text 'text'"),
        ("[1, 2, 3]", "it holds no list of samples"),
        ({"kp": 3}, "it holds no list of samples"),
        ({"a": SAMPLES, "b": SAMPLES}, "it holds 2 lists of samples, a, b"),
        ({"name": "x", "log": []}, "it holds no column of numbers"),
    ],
)
def test_any_other_shape_is_one_line(tmp_path, content, said):
    with pytest.raises(RecordError) as caught:
        read_columns(written(tmp_path, content))
    assert said in str(caught.value)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("sample", "said"),
    [
        ({"t": 1.0}, "sample 60 does not have it"),
        ({"t": 1.0, "q": "fast"}, "it holds the text 'fast' at sample 60, no number"),
        ({"t": 1.0, "q": {"x": 1}}, "sample 60 does not have it"),
        ({"t": 1.0, "q": {}}, "it holds an object at sample 60, no number"),
        ({"t": 1.0, "q": [1.0] * 65}, "it holds a list at sample 60, no number"),
    ],
)
def test_a_column_that_is_none_says_why(tmp_path, sample, said):
    columns = read_columns(written(tmp_path, [*SAMPLES, sample]))
    with pytest.raises(RecordError, match=said):
        columns["q"]


def test_objects_and_short_lists_in_a_sample_are_columns_of_their_own(tmp_path):
    samples = [{"t": 0.1 * k, "esc": {"amps": k, "cells": [3.7, 3.8]}, "mode": "eco"} for k in range(20)]
    columns = read_columns(written(tmp_path, samples))
    assert list(columns) == ["t", "esc.amps", "esc.cells[0]", "esc.cells[1]"]
    assert columns["esc.amps"].tolist() == list(range(20))
    with pytest.raises(RecordError, match=r"'esc' has 3 parts, esc.amps to esc.cells\[1\]: name one"):
        columns["esc"]


def test_lists_and_constants_may_stand_in_objects(tmp_path):
    content = {"data": {"t": [0.0, 0.1], "q": [1.0, 2.0]}, "drive": {"kp": 3.0}}
    columns = read_columns(written(tmp_path, content))
    assert {name: values.tolist() for name, values in columns.items()} == {
        "data.t": [0.0, 0.1], "data.q": [1.0, 2.0], "drive.kp": [3.0, 3.0],
    }  # fmt: skip


def test_a_name_of_two_values_is_refused(tmp_path):
    sample = {"t": 0.0, "esc.amps": 1.0, "esc": {"amps": 2.0}}
    with pytest.raises(RecordError, match=r"sample 0: 'esc\.amps' names two values, one in an object"):
        read_columns(written(tmp_path, [sample, sample]))


def test_objects_in_objects_have_an_end(tmp_path):
    deep: Any = 1.0
    for _ in range(40):
        deep = {"a": deep}
    columns = read_columns(written(tmp_path, [{"t": 0.0, "deep": deep}, {"t": 1.0, "deep": deep}]))
    assert list(columns) == ["t"]


def test_a_name_for_both_a_constant_and_a_column_is_refused(tmp_path):
    columns = read_columns(written(tmp_path, {"q": 1, "log": SAMPLES}))
    with pytest.raises(RecordError, match="both a constant and a column"):
        columns["q"]


def test_a_constant_is_a_signal_of_a_record(tmp_path):
    plan = record_map(
        {
            "files": "run.json",
            "time": {"column": "t"},
            "inputs": {"kp": {"column": "kp", "unit": "1"}},
            "outputs": {"q": {"column": "q", "unit": "rad"}},
        }
    )
    path = written(tmp_path, {"kp": 400, "log": SAMPLES})
    record = build_record("run", [path], plan.time, plan.inputs, plan.outputs)
    assert record.input("kp").tolist() == [400.0] * 60
