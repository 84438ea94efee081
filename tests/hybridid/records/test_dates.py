"""Stamps that are text, as loggers and spreadsheets write them."""

from __future__ import annotations

import json

import numpy as np
import pytest

from hybridid.records.dates import seconds_of
from hybridid.records.readers import read_columns
from hybridid.records.survey import time_found


@pytest.mark.parametrize(
    ("cells", "seconds"),
    [
        (["2026-11-25T14:00:00.123Z", "2026-11-25T14:00:00.143Z"], [0, 0.02]),
        (["2026-11-25 23:59:59", "2026-11-26 00:00:00.5"], [0, 1.5]),
        (["2026/11/25 14:00", "2026/11/25 14:01"], [0, 60]),
        (["2026-11-25T14:00:00+01:00", "2026-11-25T14:30:01+0130"], [0, 1]),
        (["2026-11-25T14:00:00-01:00", "2026-11-25T15:00:01Z"], [0, 1]),
        (["28.02.2027 23:59:59,5", "1.3.2027 0:00:00,0"], [0, 0.5]),
        (["23:59:59.9", None, "00:00:00.1", "00:00:01.1"], [0, np.nan, 0.2, 1.2]),
        (["11/25/2026 12:59:59 AM", "11/25/2026 1:00:00 am"], [0, 1]),
        (["25/11/2026 11:59:59", "25/11/2026 12:00:01"], [0, 2]),
    ],
)
def test_stamps_are_seconds_since_the_first(cells, seconds):
    np.testing.assert_allclose(seconds_of(cells), seconds, atol=1e-9)


@pytest.mark.parametrize(
    "cells",
    [
        ["eco", "sport"],
        ["12:30", "12:31"],  # hours and minutes, or minutes and seconds
        ["2026-02-30T14:00:00"],
        ["2026-11-25T14:00:00", "later"],
        ["11/12/2026 14:00:00", "12/12/2026 14:00:00"],  # a day or a month apart
        [None, None],
        [],
    ],
)
def test_other_text_is_none(cells):
    assert seconds_of(cells) is None


def test_a_column_of_dates_is_time(tmp_path):
    stamps = [f"25.11.2026 14:00:{k // 50:02},{20 * (k % 50):03}" for k in range(200)]
    text = "\n".join(["Datum;Weg [mm]", *(f"{stamp};{k},5" for k, stamp in enumerate(stamps))])
    (tmp_path / "run.csv").write_text(text)
    samples = [{"when": f"2026-11-25T14:00:{k // 50:02}.{20 * (k % 50):03}Z", "q": k} for k in range(200)]
    (tmp_path / "run.jsonl").write_text("\n".join(map(json.dumps, samples)))
    for file, name in (("run.csv", "Datum"), ("run.jsonl", "when")):
        found = time_found(read_columns(tmp_path / file))
        assert (found.column, found.unit, found.even) == (name, "s", True)
        assert found.step == pytest.approx(0.02)


def test_words_of_the_logger_stand_above_the_header(tmp_path):
    rows = [f"{0.02 * k:.2f}\t{k}\t{2 * k}" for k in range(20)]
    text = "\n".join(["Messung 12", "Bediener: X", "", "Zeit (s)\tKraft (N)\tWeg (mm)", *rows])
    (tmp_path / "run.csv").write_text(text)
    columns = read_columns(tmp_path / "run.csv")
    assert list(columns) == ["Zeit (s)", "Kraft (N)", "Weg (mm)"]
    assert columns["Weg (mm)"].tolist() == [2.0 * k for k in range(20)]
