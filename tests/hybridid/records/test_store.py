"""A record comes back from its file bit for bit, and never half written."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pyarrow.parquet as pq
import pytest

from hybridid.records.record import RecordError
from hybridid.records.store import load_record, save_record

FIELDS = (
    "name",
    "input_channels",
    "output_channels",
    "auxiliary_channels",
    "simulated",
    "source",
    "digest",
    "warnings",
)


def assert_same(a, b) -> None:
    for field in FIELDS:
        assert getattr(a, field) == getattr(b, field), field
    for field in ("time", "inputs", "outputs", "auxiliary"):
        x, y = getattr(a, field), getattr(b, field)
        assert (x is None) == (y is None), field
        assert x is None or (x.shape == y.shape and x.tobytes() == y.tobytes()), field


@pytest.mark.parametrize("seed", range(5))
def test_every_bit_survives(tmp_path, make_record, seed):
    rng = np.random.default_rng(seed)
    outputs = rng.normal(size=(300, 2)) * 10.0 ** rng.integers(-150, 55, (300, 2))
    outputs[:4, 0] = [0.0, -0.0, 5e-324, 1e-300]
    record = make_record(
        n=300,
        outputs=outputs,
        simulated=bool(seed % 2),
        warnings=("record bench: resampled, 5 µm",),
        name="Prüfstand",
    )
    path = save_record(record, tmp_path / "deep/er/record.parquet")
    assert_same(load_record(path), record)


def test_without_inputs_or_auxiliary_signals(tmp_path, make_record):
    record = make_record(inputs=np.empty((200, 0)), input_channels=(), auxiliary=None, auxiliary_channels=())
    assert_same(load_record(save_record(record, tmp_path / "free.parquet")), record)


def test_warnings_do_not_pile_up(tmp_path, make_record):
    record = make_record(inputs=np.zeros((200, 2)))
    assert len(record.warnings) == 2
    for _ in range(3):
        record = load_record(save_record(record, tmp_path / "r.parquet"))
    assert len(record.warnings) == 2


def test_other_programs_read_it(tmp_path, make_record):
    record = make_record()
    frame = pd.read_parquet(save_record(record, tmp_path / "r.parquet"))
    assert list(frame) == ["time", "force", "road", "position", "angle", "reference"]
    assert np.array_equal(frame["angle"], record.output("angle"))


def test_the_same_record_makes_the_same_file(tmp_path, make_record):
    a, b = (save_record(make_record(), tmp_path / f"{x}.parquet").read_bytes() for x in "ab")
    assert a == b


def test_a_failed_write_leaves_the_old_file_and_nothing_else(tmp_path, make_record, monkeypatch):
    path = save_record(make_record(), tmp_path / "r.parquet")
    old = path.read_bytes()

    def broken(table, where, *rest, **more):
        where.write_bytes(b"half")
        raise OSError("disk full")

    monkeypatch.setattr(pq, "write_table", broken)
    with pytest.raises(OSError, match="disk full"):
        save_record(make_record(seed=1), path)
    assert path.read_bytes() == old
    assert list(tmp_path.iterdir()) == [path]


def test_what_is_no_record_of_ours_is_one_line(tmp_path):
    with pytest.raises(RecordError, match="no such file"):
        load_record(tmp_path / "none.parquet")
    (tmp_path / "broken.parquet").write_bytes(b"PAR1 nothing")
    pd.DataFrame({"time": [0.0, 1.0]}).to_parquet(tmp_path / "other.parquet")
    for name in ("broken", "other"):
        with pytest.raises(RecordError, match=f"{name}.parquet: not a record that hybridid wrote"):
            load_record(tmp_path / f"{name}.parquet")


def test_absent_cells_survive_the_file(make_record, tmp_path):
    absent = np.zeros((200, 2), dtype=bool)
    absent[20:30, 1] = absent[5, 0] = absent[40, 0] = absent[40, 1] = True
    record = make_record(absent=absent)
    again = load_record(save_record(record, tmp_path / "one.parquet"))
    np.testing.assert_array_equal(again.absent, record.absent)
    assert again.masked == record.masked == ((40, 41, True),)
