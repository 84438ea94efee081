"""Files as loggers and laboratories write them: HDF5, JSON lines, a row of units, a name over two columns."""

from __future__ import annotations

import json

import h5py
import numpy as np
import pytest

from hybridid.records.readers import read_columns
from hybridid.records.record import RecordError
from hybridid.records.survey import columns_found, labelled

T = 0.01 * np.arange(50)
Q = np.sin(T)


@pytest.mark.parametrize("suffix", [".h5", ".hdf5"])
def test_hdf5_groups_matrices_and_tables(tmp_path, suffix):
    path = tmp_path / f"run{suffix}"
    with h5py.File(path, "w") as file:
        file["t"] = T
        file["run/both"] = np.column_stack([Q, 2 * Q]).astype(np.float32)
        file["run/kp"] = 400
        file["log"] = np.array(list(zip(T, Q, strict=True)), dtype=[("stamp", float), ("angle", float)])
        file["run/remark"] = "first try"
    columns = read_columns(path)
    assert set(columns) == {"t", "run/both[0]", "run/both[1]", "run/kp", "log/stamp", "log/angle"}
    np.testing.assert_allclose(columns["run/both[1]"], 2 * Q, rtol=1e-6)
    np.testing.assert_array_equal(columns["log/angle"], Q)
    assert columns["run/kp"].tolist() == [400.0]
    with pytest.raises(RecordError, match="'run/remark' cannot be a signal"):
        columns["run/remark"]


def test_what_is_no_hdf5_is_one_line(tmp_path):
    (tmp_path / "run.h5").write_text("t,q")
    with pytest.raises(RecordError, match=r"not a readable \.h5 file"):
        read_columns(tmp_path / "run.h5")


def test_json_lines(tmp_path):
    path = tmp_path / "run.jsonl"
    path.write_text("\n".join(json.dumps({"t": t, "q": q}) for t, q in zip(T, Q, strict=True)) + "\n\n")
    columns = read_columns(path)
    np.testing.assert_array_equal(columns["q"], Q)


@pytest.mark.parametrize(
    ("line", "said"), [('{"t": 0.5, "q', "line 51 is no JSON"), ("[1, 2]", "line 51 holds a list")]
)
def test_a_line_that_is_no_sample_is_named(tmp_path, line, said):
    path = tmp_path / "run.jsonl"
    path.write_text("\n".join([json.dumps({"t": t}) for t in T] + [line]))
    with pytest.raises(RecordError, match=said):
        read_columns(path)


@pytest.mark.parametrize("units", ["s,deg,N·m", "[s],[deg],[N·m]", "(s), (deg), ", "s,deg,1"])
def test_a_row_of_units_joins_the_header(tmp_path, units):
    path = tmp_path / "run.csv"
    path.write_text(
        "\n".join(["t,angle,torque", units, *(f"{t},{q},{2 * q}" for t, q in zip(T, Q, strict=True))])
    )
    columns = read_columns(path)
    assert list(columns)[:2] == ["t [s]", "angle [deg]"]
    np.testing.assert_array_equal(columns["angle [deg]"], Q)
    assert [labelled(one.name).unit for one in columns_found(columns)][:2] == ["s", "deg"]


def test_a_row_of_ones_is_data(tmp_path):
    (tmp_path / "run.csv").write_text("t,a,b\n1,1,1\n2,1,1\n")
    assert read_columns(tmp_path / "run.csv")["t"].tolist() == [1.0, 2.0]


def test_a_row_of_other_words_is_no_row_of_units(tmp_path):
    path = tmp_path / "run.csv"
    path.write_text("t,q\nstarted,here\n0,1\n1,2\n")
    with pytest.raises(RecordError, match="it holds no column of numbers"):
        read_columns(path)


def test_two_columns_of_one_name_are_asked_about(tmp_path):
    path = tmp_path / "run.csv"
    path.write_text("\n".join(["t,q,q", *(f"{t},{q},{2 * q}" for t, q in zip(T, Q, strict=True))]))
    columns = read_columns(path)
    assert list(columns) == ["t", "q[0]", "q[1]"]
    np.testing.assert_array_equal(columns["q[1]"], 2 * Q)
    with pytest.raises(RecordError, match=r"'q' has 2 parts, q\[0\] to q\[1\]: name one of them"):
        columns["q"]


@pytest.mark.parametrize("word", ["NAN", "Nan", "none", "NA"])
def test_a_word_for_what_is_missing_is_a_gap(tmp_path, word):
    path = tmp_path / "run.csv"
    path.write_text("t,q\n" + "".join(f"{t},{word if t == T[7] else t}\n" for t in T))
    (gap,) = np.flatnonzero(np.isnan(read_columns(path)["q"]))
    assert gap == 7


def test_a_column_of_two_words_is_to_be_written_as_numbers(tmp_path):
    path = tmp_path / "run.csv"
    path.write_text("t,heater\n" + "".join(f"{t},{'ON' if t < 0.2 else 'OFF'}\n" for t in T))
    with pytest.raises(
        RecordError, match="the words 'OFF' and 'ON', no numbers: write 0 and 1 in their place"
    ):
        read_columns(path)["heater"]
