"""Columns become signals in their units; a mistake in the map or the file says what and where."""

from __future__ import annotations

import hashlib
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
import scipy.io

from hybridid.records.mapping import build_record, read_record, record_map
from hybridid.records.record import Record, RecordError
from hybridid.records.resample import Resample
from hybridid.records.sources import RecordNotFoundError

N = 400
T = np.arange(N) * 1e-3
RNG = np.random.default_rng(5)
VIR, QM, QG = RNG.normal(size=(3, N))
GTAU = 35.15

EMPS = {
    "files": "emps/run.mat",
    "time": {"column": "t"},
    "inputs": {"force": {"unit": "N", "column": "vir", "factor": "gtau", "hold": "zoh"}},
    "outputs": {"position": {"unit": "mm", "column": "qm", "scale": 1000, "sign": -1, "offset": 4.0}},
    "auxiliary": {"reference": {"unit": "m", "column": "qg", "meaning": "what it should follow"}},
}


@pytest.fixture
def root(tmp_path) -> Path:
    (tmp_path / "emps").mkdir()
    scipy.io.savemat(tmp_path / "emps/run.mat", {"t": T, "vir": VIR, "qm": QM, "qg": QG, "gtau": GTAU})
    return tmp_path


def read(root: Path, **changes: Any) -> Record:
    return read_record("bench", record_map({**EMPS, **changes}), [root])


def test_signals_come_out_in_their_units(root):
    record = read(root)
    np.testing.assert_allclose(record.input("force"), GTAU * VIR, rtol=1e-15)
    np.testing.assert_allclose(record.output("position"), 4.0 - 1000 * QM, rtol=1e-14)
    assert np.array_equal(record.signal("reference"), QG)
    assert np.array_equal(record.time, T)
    assert [(c.name, c.unit, c.hold) for c in record.input_channels] == [("force", "N", "zoh")]
    assert record.auxiliary_channels[0].meaning == "what it should follow"
    assert record.warnings == ()
    assert not record.simulated


def test_the_digest_is_that_of_the_file(root):
    file = root / "emps/run.mat"
    assert read(root).digest == hashlib.sha256(file.read_bytes()).hexdigest()
    assert read(root).source == str(file)


@pytest.mark.parametrize(
    ("time", "expected"),
    [
        ({"dt": 0.002}, np.arange(N) * 0.002),
        ({"rate": 610.35}, np.arange(N) / 610.35),
        ({"column": "t", "unit": "ms"}, T * 1e-3),
        ({"column": "t", "unit": "min"}, T * 60),
    ],
)
def test_time_from_a_column_a_step_or_a_rate(root, time, expected):
    np.testing.assert_allclose(read(root, time=time).time, expected, rtol=1e-14)


def test_dates_are_in_seconds_whatever_the_unit_says(root):
    dates = pd.Timestamp("2026-03-01") + pd.to_timedelta(T, unit="s")
    pd.DataFrame({"t": dates, "vir": T, "qm": T}).to_parquet(root / "emps/run.parquet")
    changes = {"files": ["emps/run.parquet"], "inputs": [], "outputs": {"q": {"unit": "m", "column": "qm"}}}
    np.testing.assert_allclose(read(root, **changes, auxiliary=[], time={"column": "t"}).time, T, atol=1e-9)
    with pytest.raises(RecordError, match="'t' holds dates or durations, which are read in s: unit 'ms'"):
        read(root, **changes, auxiliary=[], time={"column": "t", "unit": "ms"})


@pytest.mark.parametrize(
    ("time", "said"),
    [
        ({}, "record: time: time needs exactly one of column, dt, rate, got none"),
        ({"column": "t", "dt": 0.1}, "exactly one of column, dt, rate, got column, dt"),
        ({"dt": 0.0}, "dt is 0, it must be positive"),
        ({"rate": -5}, "rate is -5, it must be positive"),
        ({"column": "t", "unit": "sec"}, "record: time: unknown unit 'sec'.*allowed: s, ms"),
        ({"dt": 0.1, "same": ["t"]}, "same compares with column"),
        ({"colunm": "t"}, "record: time: unknown key 'colunm': did you mean 'column'"),
    ],
)
def test_an_impossible_time(time, said):
    with pytest.raises(RecordError, match=said):
        record_map({**EMPS, "time": time})


@pytest.mark.parametrize(
    ("signal", "said"),
    [
        ({"sign": 2}, "record: inputs.force: sign is 2, allowed: 1, -1"),
        ({"scale": 0}, "inputs.force: scale is 0 and offset 0: must be finite, and scale not 0"),
        ({"offset": float("inf")}, "scale is 1 and offset inf: must be finite"),
        ({"column": ""}, "inputs.force: column is empty"),
        ({"unit": "N" * 500}, "unit is .*: at most 60 characters"),
        ({"unit": "N\n"}, "unit is .*: at most 60 characters in one line"),
        ({"hold": "cubic"}, "hold is 'cubic': allowed: zoh, foh, bandlimited"),
        ({"colum": "vir"}, "unknown key 'colum': did you mean 'column'"),
        ({"unit": None}, "key 'unit' is missing"),
        ({"scale": "1k"}, "scale is '1k': expected a number"),
    ],
)
def test_an_impossible_signal(signal, said):
    with pytest.raises(RecordError, match=said):
        record_map({**EMPS, "inputs": {"force": {"unit": "N", "column": "vir", **signal}}})


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"files": []}, "files is empty"),
        ({"outputs": {}}, "outputs is empty"),
        ({"resample": 0}, "resample: dt is 0 s, it must be positive"),
        ({"resample": {"dt": -1}}, "resample: dt is -1 s"),
        ({"outputs": {"force": EMPS["outputs"]["position"]}}, "the name 'force' is taken twice"),
        ({"outputs": {"time": EMPS["outputs"]["position"]}}, "the name 'time' is taken twice"),
        ({"inputs": {"": EMPS["inputs"]["force"]}}, "'' is no name of a signal"),
        ({"inputs": {"force": 3}}, "record: inputs.force: expected a mapping"),
    ],
)
def test_an_impossible_record_is_refused_before_any_file_is_read(changes, said):
    with pytest.raises(RecordError, match=said):
        record_map({**EMPS, **changes})


def test_a_machine_may_have_no_input(root):
    assert read(root, inputs={}).inputs.shape == (N, 0)


def test_a_column_of_many_parts_is_one_short_line(root):
    cells = np.empty(2000, dtype=object)
    cells[:] = [np.array([float(k)]) for k in range(2000)]
    scipy.io.savemat(root / "emps/run.mat", {"t": T, "vir": cells, "qm": QM, "qg": QG, "gtau": GTAU})
    with pytest.raises(
        RecordError, match=r"'vir' has 2000 parts, vir\[0\] to vir\[1999\]: name one"
    ) as caught:
        read(root)
    assert len(str(caught.value)) < 300


def test_a_file_name_that_no_file_can_have_is_not_found(root):
    for name in ("x" * 5000 + ".mat", "a\0b.mat"):
        with pytest.raises(RecordNotFoundError, match="not found") as caught:
            read(root, files=name)
        assert len(str(caught.value)) < 600


def test_signals_may_be_a_list_too(root):
    listed = read(root, inputs=[{"name": "force", "unit": "N", "column": "vir", "factor": "gtau"}])
    assert np.array_equal(listed.inputs, read(root).inputs)


@pytest.mark.parametrize("key", ["column", "factor"])
def test_a_misnamed_column_names_file_and_neighbours(root, key):
    signal = {"unit": "N", "column": "vir", key: "gtaw" if key == "factor" else "virr"}
    with pytest.raises(RecordError) as caught:
        read(root, inputs={"force": signal})
    nearest = "gtau" if key == "factor" else "vir"
    assert "run.mat" in str(caught.value)
    assert f"did you mean '{nearest}'?" in str(caught.value)
    assert "qg, qm, t, vir" in str(caught.value)


def test_a_column_may_be_the_factor(root):
    record = read(root, inputs={"power": {"unit": "W", "column": "vir", "factor": "qm"}})
    np.testing.assert_allclose(record.input("power"), VIR * QM, rtol=1e-15)


def test_lengths_that_differ_are_listed(root):
    scipy.io.savemat(root / "emps/run.mat", {"t": T, "vir": VIR[:-3], "qm": QM, "qg": QG, "gtau": GTAU})
    with pytest.raises(RecordError, match="lengths differ: time 400, force 397, position 400, reference 400"):
        read(root)


def test_a_missing_file_is_told_from_a_broken_one(root):
    with pytest.raises(RecordNotFoundError, match=r"emps/rnu.mat not found, did you mean .*run.mat\?"):
        read(root, files="emps/rnu.mat")
    (root / "emps/run.mat").write_bytes(b"nothing")
    with pytest.raises(RecordError) as caught:
        read(root)
    assert not isinstance(caught.value, RecordNotFoundError)


def several(root: Path, late: float = 0.0) -> dict[str, Any]:
    """One recording in three files, as the flexible link's."""
    stamps = {"vm": T, "theta": T, "alpha": T + late}
    for name, values in {"vm": VIR, "theta": QM, "alpha": QG}.items():
        scipy.io.savemat(root / f"{name}.mat", {f"data_{name}": np.column_stack([stamps[name], values])})
    return {
        "files": ["vm.mat", "theta.mat", "alpha.mat"],
        "time": {"column": "data_vm[0]", "same": ["data_theta[0]", "data_alpha[0]"]},
        "inputs": {"voltage": {"unit": "V", "column": "data_vm[1]"}},
        "outputs": {
            "theta": {"unit": "deg", "column": "data_theta[1]"},
            "alpha": {"unit": "deg", "column": "data_alpha[1]"},
        },
    }


def test_several_files_make_one_record(root):
    record = read_record("link", record_map(several(root)), [root])
    assert np.array_equal(record.inputs[:, 0], VIR)
    assert np.array_equal(record.outputs, np.column_stack([QM, QG]))
    assert record.auxiliary is None
    digests = sorted(hashlib.sha256((root / f).read_bytes()).hexdigest() for f in several(root)["files"])
    assert record.digest == hashlib.sha256("\n".join(digests).encode()).hexdigest()


def test_files_of_different_runs_are_refused(root):
    with pytest.raises(
        RecordError, match=r"'data_vm\[0\]' and 'data_alpha\[0\]' differ: not recorded together"
    ):
        read_record("link", record_map(several(root, late=1e-4)), [root])


def test_an_uneven_record_passes_only_when_resampling_is_asked_for(tmp_path):
    keep = np.r_[0:100, 120:N]
    frame = pd.DataFrame({"t": T, "u": VIR, "y": np.sin(20 * T)}).iloc[keep]
    frame.to_csv(tmp_path / "run.csv", index=False)
    plan = {
        "files": str(tmp_path / "run.csv"),
        "time": {"column": "t"},
        "inputs": {"u": {"unit": "V", "column": "u"}},
        "outputs": {"y": {"unit": "m", "column": "y"}},
    }
    left_out = "'records.holed.steps=[{step: mask, stretches: [[0.099, 0.12]], through: false}]'"
    with pytest.raises(RecordError, match=r"time is uneven: step 0\.021 s from sample 99") as raised:
        read_record("holed", record_map(plan), [])
    assert str(raised.value).endswith(f"in that step, so leave it out too, by {left_out}")
    record = read_record("holed", record_map({**plan, "resample": 0.001}), [])
    assert record.n == N
    assert any("resampled onto an even grid of 0.001 s (pchip" in w for w in record.warnings)
    (told,) = [w for w in record.warnings if "0.021 s without a sample from t = 0.099 s" in w]
    assert told.endswith(f"{left_out} leaves them out")
    assert np.abs(record.output("y") - np.sin(20 * T)).max() < 0.02
    linear = read_record("holed", record_map({**plan, "resample": {"dt": 0.001, "method": "linear"}}), [])
    assert any("(linear" in w for w in linear.warnings)


@pytest.fixture
def gappy(tmp_path):
    """A plan of two outputs at even stamps; the angle drops out at samples 7 to 9, both at sample 50."""
    angle, force = np.sin(20 * T), VIR.copy()
    angle[7:10] = angle[50] = force[50] = np.nan
    pd.DataFrame({"t": T, "q": angle, "F": force}).to_csv(tmp_path / "run.csv", index=False)
    outputs = {"angle": {"unit": "rad", "column": "q"}, "force": {"unit": "N", "column": "F"}}
    return {"files": str(tmp_path / "run.csv"), "time": {"column": "t"}, "outputs": outputs}


def test_missing_cells_end_with_the_key_that_masks_them(gappy):
    with pytest.raises(RecordError) as said:
        read_record("run", record_map(gappy), [])
    assert str(said.value) == (
        f"record run: output 'angle' [rad] is missing (NaN) at sample 7 (t = {T[7]:g} s), 4 of {N} "
        "samples are; set signals.outputs.angle.missing=mask to leave them out "
        "(records.run.outputs.angle.missing where the record has outputs of its own)"
    )


def test_missing_cells_are_masked_where_asked(gappy):
    for output in gappy["outputs"].values():
        output["missing"] = "mask"
    record = read_record("run", record_map(gappy), [])
    assert record.absent.sum(axis=0).tolist() == [3, 0]
    assert [tuple(one) for one in record.masked] == [(50, 51, True)]  # nothing was measured there
    assert record.output("angle")[8] == pytest.approx(np.sin(20 * T[8]), abs=1e-3)
    assert np.isnan(record.measured[7:10, 0]).all()
    assert record.warnings[0] == (
        f"record run: output 'angle' is missing at 4 of the {N} samples of its files, the first at "
        f"t = {T[7]:g} s: masked"
    )
    finer = read_record("run", record_map({**gappy, "resample": 0.0005}), [])
    absent = finer.time[finer.absent[:, 0]]
    assert absent.min() > T[6]
    assert absent.max() < T[10]
    assert len(absent) == 7


def test_only_an_output_may_be_masked_where_it_is_missing(gappy):
    gappy["inputs"] = {"force": {**gappy["outputs"].pop("force"), "missing": "mask"}}
    gappy["outputs"]["angle"]["missing"] = "mask"
    with pytest.raises(RecordError, match="input 'force' has missing: mask, which only an output may have"):
        read_record("run", record_map(gappy), [])
    del gappy["inputs"]["force"]["missing"]
    with pytest.raises(RecordError, match="what drives the model must be known throughout"):
        read_record("run", record_map(gappy), [])


def test_an_auxiliary_signal_may_be_interpolated(gappy):
    """As a temperature that is logged less often. It may not be masked, nor an output interpolated."""
    gappy["auxiliary"] = {"oil": {"unit": "N", "column": "F"}}
    del gappy["outputs"]["force"]
    gappy["outputs"]["angle"]["missing"] = "mask"
    with pytest.raises(RecordError, match=r"set signals\.auxiliary\.oil\.missing=interpolate to draw"):
        read_record("run", record_map(gappy), [])
    gappy["auxiliary"]["oil"]["missing"] = "interpolate"
    record = read_record("run", record_map(gappy), [])
    assert record.signal("oil")[50] == pytest.approx((VIR[49] + VIR[51]) / 2)
    assert record.warnings[1] == (
        f"record run: auxiliary 'oil' is missing at 1 of the {N} samples of its files, the first at "
        f"t = {T[50]:g} s: interpolated, over {T[51] - T[49]:.3g} s at most"
    )
    gappy["auxiliary"]["oil"]["missing"] = "mask"
    with pytest.raises(RecordError, match="has missing: mask, which only an output may have"):
        read_record("run", record_map(gappy), [])
    gappy["outputs"]["angle"]["missing"] = "interpolate"
    with pytest.raises(RecordError, match="missing: interpolate, which only an auxiliary signal may have"):
        read_record("run", record_map(gappy), [])


def test_resampling_does_not_spread_a_missing_value(tmp_path):
    values = VIR.copy()
    values[7] = np.nan
    pd.DataFrame({"t": T, "y": values}).to_csv(tmp_path / "run.csv", index=False)
    plan = record_map(
        {
            "files": str(tmp_path / "run.csv"),
            "time": {"column": "t"},
            "inputs": [],
            "outputs": {"y": {"unit": "m", "column": "y"}},
            "resample": 0.001,
        }
    )
    with pytest.raises(RecordError, match=r"'y' \[m\] is missing \(NaN\) at sample 7 \(t = 0.007 s\)"):
        read_record("gap", plan, [])
    with pytest.raises(RecordError, match="names no file"):
        build_record("none", [], plan.time, [], plan.outputs, resample=Resample(1e-3))
