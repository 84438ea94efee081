"""Every format gives the same numbers under the names that are documented, and broken files are one line."""

from __future__ import annotations

from pathlib import Path

import h5py
import numpy as np
import pandas as pd
import pytest
import scipy.io

from hybridid.records.columns import find_column, find_time
from hybridid.records.readers import read_columns
from hybridid.records.record import RecordError

N = 50
RNG = np.random.default_rng(0)
TIME = np.arange(N) * 1e-3
FORCE = RNG.normal(size=N)
MATRIX = RNG.normal(size=(N, 3))


def write_v5(path: Path) -> None:
    variables = {"t": TIME[:, None], "vir": FORCE[None, :], "gtau": 35.15, "data": MATRIX, "note": "text"}
    scipy.io.savemat(
        path, {**variables, "run": {"position": FORCE, "gain": 2.0}, "nothing": np.zeros((0, 0))}
    )


def write_v73(path: Path) -> None:
    """As MATLAB does: HDF5 after a header of 512 bytes, arrays transposed, their class in an attribute."""

    def put(group: h5py.Group, name: str, value: np.ndarray, kind: bytes = b"double") -> None:
        group.create_dataset(name, data=value).attrs["MATLAB_class"] = np.bytes_(kind)

    with h5py.File(path, "w", userblock_size=512) as file:
        put(file, "t", TIME[None, :])
        put(file, "vir", FORCE[:, None])
        put(file, "gtau", np.array([[35.15]]))
        put(file, "data", MATRIX.T)
        put(file, "note", np.array([[ord(c)] for c in "text"], dtype=np.uint16), b"char")
        run = file.create_group("run")
        run.attrs["MATLAB_class"] = np.bytes_(b"struct")
        put(run, "position", FORCE[None, :])
        put(run, "gain", np.array([[2.0]]))
    header = b"MATLAB 7.3 MAT-file, Platform: GLNXA64, HDF5 schema 1.00 .".ljust(124) + b"\x00\x02IM"
    with path.open("r+b") as file:
        file.write(header)


@pytest.mark.parametrize("write", [write_v5, write_v73])
def test_matlab_files_of_both_kinds(tmp_path, write):
    path = tmp_path / "run.mat"
    write(path)
    columns = read_columns(path)
    assert np.array_equal(columns["t"], TIME)
    assert np.array_equal(columns["vir"], FORCE)
    assert columns["gtau"].tolist() == [35.15]
    assert np.array_equal(columns["run.position"], FORCE)
    assert columns["run.gain"].tolist() == [2.0]
    for j in range(3):
        assert np.array_equal(columns[f"data[{j}]"], MATRIX[:, j])
    with pytest.raises(RecordError, match="'note' cannot be a signal"):
        columns["note"]


def test_signals_of_a_matrix_run_along_its_longer_axis(tmp_path):
    scipy.io.savemat(tmp_path / "wide.mat", {"data": MATRIX.T})
    columns = read_columns(tmp_path / "wide.mat")
    assert sorted(columns) == ["data[0]", "data[1]", "data[2]"]
    assert np.array_equal(columns["data[2]"], MATRIX[:, 2])


def test_matlab_integers_and_singles_become_floats(tmp_path):
    pulses = (RNG.random(N) > 0.5).astype(np.uint8) * 5
    scipy.io.savemat(
        tmp_path / "a.mat", {"pulses": pulses, "single": FORCE.astype(np.float32), "z": FORCE * 1j}
    )
    columns = read_columns(tmp_path / "a.mat")
    assert columns["pulses"].dtype == float
    assert np.array_equal(columns["pulses"], pulses)
    assert np.array_equal(columns["single"], FORCE.astype(np.float32).astype(float))
    with pytest.raises(RecordError, match="'z' cannot be a signal: it holds complex numbers"):
        columns["z"]


CSV = {
    "plain": "t,V1\n0.0,1.5\n0.1,-2\n0.2,3e-1\n",
    "quoted header, trailing commas": '"t","V1",\n0.0,1.5,\n0.1,-2,\n0.2,3e-1,\n',
    "trailing commas in the rows only": "t,V1\n0.0,1.5,\n0.1,-2,\n0.2,3e-1,\n",
    "spaces": "t , V1\n 0.0 , 1.5\n 0.1 , -2\n 0.2 , 3e-1\n",
    "semicolons": "t;V1\n0.0;1.5\n0.1;-2\n0.2;3e-1\n",
    "semicolons and decimal commas": "t;V1\n0,0;1,5\n0,1;-2,0\n0,2;3e-1\n",
    "tabs": "t\tV1\n0.0\t1.5\n0.1\t-2\n0.2\t3e-1\n",
    "byte order mark": "\ufefft,V1\n0.0,1.5\n0.1,-2\n0.2,3e-1\n",
    "Windows lines": "t,V1\r\n0.0,1.5\r\n0.1,-2\r\n0.2,3e-1\r\n",
    "comments first": "# rig 3\n# 2024\nt,V1\n0.0,1.5\n0.1,-2\n0.2,3e-1\n",
    "blank lines": "\nt,V1\n0.0,1.5\n0.1,-2\n0.2,3e-1\n\n",
}


@pytest.mark.parametrize("name", CSV)
def test_csv_as_loggers_write_it(tmp_path, name):
    path = tmp_path / "run.csv"
    path.write_bytes(CSV[name].encode())
    columns = read_columns(path)
    assert dict(columns).keys() == {"t", "V1"}
    assert columns.unusable == {}
    assert columns["t"].tolist() == [0.0, 0.1, 0.2]
    assert columns["V1"].tolist() == [1.5, -2.0, 0.3]


@pytest.mark.parametrize(
    ("rows", "line"),
    [
        ("0.0,1.5,7\n0.1,-2\n", 2),
        ("0.0,1.5\n0.1,-2,,7\n", 3),
        ("0.0,1.5,7\n0.1,-2,7\n", 2),
        ("0.0,1.5,\n0.1,-2,7\n", 3),
    ],
    ids=["first row", "a later row", "every row", "a cell behind trailing commas"],
)
def test_csv_cells_beyond_the_header_are_no_samples(tmp_path, rows, line):
    (tmp_path / "run.csv").write_text(f"t,V1\n{rows}")
    with pytest.raises(RecordError, match=rf"line {line}\b"):
        read_columns(tmp_path / "run.csv")


def test_csv_without_a_header_is_counted(tmp_path):
    (tmp_path / "run.csv").write_text("0.0,1.5\n0.1,-2\n")
    columns = read_columns(tmp_path / "run.csv")
    assert columns["[0]"].tolist() == [0.0, 0.1]
    assert columns["[1]"].tolist() == [1.5, -2.0]


def test_csv_in_latin_1(tmp_path):
    (tmp_path / "run.csv").write_bytes("angle [°],F #1\n1,2\n3,4\n".encode("latin-1"))
    columns = read_columns(tmp_path / "run.csv")
    assert columns["angle [°]"].tolist() == [1, 3]
    assert columns["F #1"].tolist() == [2, 4]


@pytest.mark.parametrize("sign", ["\x0c", "\x1c", "\x85"])
def test_a_line_of_csv_ends_where_csv_says(tmp_path, sign):
    """In Latin-1 of Windows, 0x85 is an ellipsis; Python's splitlines ends a line there."""
    (tmp_path / "run.csv").write_bytes(f"t;a{sign}b;c\n0,5;1;2\n1,5;3;4\n".encode("latin-1"))
    columns = read_columns(tmp_path / "run.csv")
    assert list(columns) == ["t", f"a{sign}b", "c"]
    assert columns["t"].tolist() == [0.5, 1.5]


def test_columns_of_parquet_that_are_no_numbers_leave_the_others(tmp_path):
    strange = {
        "lists": [[1.0], [2.0]], "mappings": [{"a": 1}] * 2, "nothing": [None] * 2,
        "dates": pd.to_datetime([None, None]),
    }  # fmt: skip
    pd.DataFrame({"t": [0.0, 1.0], **strange}).to_parquet(tmp_path / "run.parquet")
    columns = read_columns(tmp_path / "run.parquet")
    assert list(columns) == ["t"]
    for name in strange:
        with pytest.raises(RecordError, match=f"'{name}' cannot be a signal: it (holds|is empty)"):
            columns[name]


def test_csv_keeps_every_digit(tmp_path):
    pd.DataFrame({"x": FORCE}).to_csv(tmp_path / "run.csv", index=False)
    assert np.array_equal(read_columns(tmp_path / "run.csv")["x"], FORCE)


def test_csv_gaps_stay_gaps_and_text_is_no_signal(tmp_path):
    (tmp_path / "run.csv").write_text("t,V1,state,empty\n0,1,3,\n1,,off,\n2,5,4,\n")
    columns = read_columns(tmp_path / "run.csv")
    assert np.isnan(columns["V1"]).tolist() == [False, True, False]
    with pytest.raises(
        RecordError, match=r"'state' cannot be a signal: it holds 'off' at sample 1 \(the first is 0\)"
    ):
        columns["state"]
    with pytest.raises(RecordError, match="'empty' cannot be a signal: it is empty"):
        columns["empty"]


def test_parquet(tmp_path):
    clock = pd.Timestamp("2026-03-01 12:00") + pd.to_timedelta(TIME, unit="s")
    gaps = FORCE.copy()
    gaps[3] = np.nan
    frame = pd.DataFrame({"F": FORCE, "gaps": gaps, "n": np.arange(N), "clock": clock, "note": "x"})
    frame.to_parquet(tmp_path / "run.parquet", index=False)
    columns = read_columns(tmp_path / "run.parquet")
    assert np.array_equal(columns["F"], FORCE)
    assert np.array_equal(columns["gaps"], gaps, equal_nan=True)
    assert np.array_equal(columns["n"], np.arange(N))
    np.testing.assert_allclose(columns["clock"], TIME, atol=1e-9)
    with pytest.raises(RecordError, match="'note' cannot be a signal"):
        columns["note"]


def test_parquet_with_time_as_its_index(tmp_path):
    pd.DataFrame({"F": FORCE}, index=pd.Index(TIME, name="t")).to_parquet(tmp_path / "run.parquet")
    columns = read_columns(tmp_path / "run.parquet")
    assert np.array_equal(columns["t"], TIME)
    assert sorted(columns) == ["F", "t"]


def test_a_misnamed_column_gives_the_nearest_and_the_list(tmp_path):
    write_v5(tmp_path / "run.mat")
    columns = read_columns(tmp_path / "run.mat")
    with pytest.raises(RecordError) as caught:
        columns["virr"]
    assert f"{tmp_path / 'run.mat'}: unknown column 'virr': did you mean 'vir'?" in str(caught.value)
    assert "data[0], data[1], data[2], gtau" in str(caught.value)
    assert "virr" not in columns


@pytest.mark.parametrize("suffix", [".mat", ".csv", ".parquet"])
@pytest.mark.parametrize("content", [b"", b"\x00\x01\x02 no such thing \xff" * 20])
def test_a_broken_file_is_one_line(tmp_path, suffix, content):
    path = tmp_path / f"run{suffix}"
    path.write_bytes(content)
    with pytest.raises(RecordError) as caught:
        read_columns(path)
    assert str(caught.value).startswith(f"{path}: ")
    assert "\n" not in str(caught.value)


def test_a_missing_file_and_a_strange_suffix(tmp_path):
    with pytest.raises(RecordError, match=r"run.mat: no such file"):
        read_columns(tmp_path / "run.mat")
    with pytest.raises(
        RecordError, match=r"\.doc is not read; allowed: \.mat, \.csv, \.tsv, .*\.jsonl, .*\.parquet"
    ):
        read_columns(tmp_path / "run.doc")
    with pytest.raises(RecordError, match=r"run\.xlsx: \.xlsx is not read: save its sheet as CSV"):
        read_columns(tmp_path / "run.xlsx")


@pytest.mark.parametrize("suffix", ["txt", "dat", "csv"])
def test_numbers_between_spaces_are_columns(tmp_path, suffix):
    """As numpy.savetxt writes them, and with names above them."""
    samples = np.column_stack([0.01 * np.arange(30), np.sin(np.arange(30)), -np.ones(30)])
    path = tmp_path / f"run.{suffix}"
    np.savetxt(path, samples, header="a log of the bench")
    bare = read_columns(path)
    np.testing.assert_allclose(bare["[1]"], samples[:, 1])
    path.write_text(
        "t   force position\n" + "\n".join("  ".join(f"{x:9.5f}" for x in row) for row in samples)
    )
    named = read_columns(path)
    assert list(named) == ["t", "force", "position"]
    np.testing.assert_allclose(named["force"], samples[:, 1], atol=1e-5)


def test_names_with_spaces_above_tabs_stay_whole(tmp_path):
    (tmp_path / "run.tsv").write_text("time s\tthe force\n" + "\n".join(f"{k}\t{2 * k}" for k in range(9)))
    assert list(read_columns(tmp_path / "run.tsv")) == ["time s", "the force"]


def test_a_column_among_several_files(tmp_path):
    for name, value in (("one", 1.0), ("two", 2.0)):
        pd.DataFrame({"t": TIME, f"x_{name}": value}).to_csv(tmp_path / f"{name}.csv", index=False)
    tables = [read_columns(tmp_path / f"{name}.csv") for name in ("one", "two")]
    assert find_column("x_two", tables)[0] == 2.0
    assert np.array_equal(find_column("two:t", tables), TIME)
    assert np.array_equal(find_column("two.csv:t", tables), TIME)
    with pytest.raises(RecordError, match="column 't' is in 2 files; say which: one:t, two:t"):
        find_column("t", tables)
    with pytest.raises(RecordError, match=r"one.csv, two.csv: unknown column 'x_tow': did you mean 'x_two'"):
        find_column("x_tow", tables)
    with pytest.raises(RecordError, match=r"two.csv: unknown column 'x'"):
        find_column("two:x", tables)


@pytest.mark.parametrize("instants", ["clock", "elapsed"])
def test_dates_and_durations_are_time_and_never_a_signal(tmp_path, instants):
    """A column of dates was read as a torque of seconds, one of durations as a torque of nanoseconds."""
    elapsed = pd.to_timedelta(TIME, unit="s")
    frame = pd.DataFrame({"F": FORCE, "clock": pd.Timestamp("2026-03-01") + elapsed, "elapsed": elapsed})
    frame.to_parquet(tmp_path / "run.parquet")
    tables = [read_columns(tmp_path / "run.parquet")]
    stamps, in_seconds = find_time(instants, tables)
    assert in_seconds
    np.testing.assert_allclose(stamps, TIME, atol=1e-9)
    with pytest.raises(RecordError, match=f"'{instants}' cannot be a signal: it holds dates or durations"):
        find_column(instants, tables)
