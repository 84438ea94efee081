"""What a recording tells of itself."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from hybridid.records.columns import Columns
from hybridid.records.mapping import TimeMap
from hybridid.records.record import RecordError
from hybridid.records.survey import columns_found, labelled, other_unit_of_time, time_found, words_of

T = 0.002 * np.arange(200)


def columns(**found) -> Columns:
    return Columns(Path("run.csv"), found, {})


@pytest.mark.parametrize(
    ("name", "label", "unit"),
    [
        ("angle [deg]", "angle", "deg"),
        ("Position (mm)", "Position", "mm"),
        ("Winkel[°]", "Winkel", "°"),
        ("speed in rpm", "speed", "rpm"),
        ("t_ms", "t", "ms"),
        ("speed_rad_s", "speed", "rad/s"),
        ("car_speed_km_h", "car_speed", "km/h"),
        ("acc_m_s2", "acc", "m/s2"),
        ("pos [counts]", "pos", "counts"),
        ("F [a.u.]", "F", "a.u."),  # in brackets stands a unit, whether we know it or not
        ("motor_current", "motor_current", ""),
        ("x_1", "x_1", ""),
        ("data_vm[1]", "data_vm[1]", ""),  # a part of a matrix
        ("u", "u", ""),
    ],
)
def test_a_unit_stands_at_the_end_of_a_name(name, label, unit):
    assert labelled(name) == (label, unit)


def test_words_of_a_name():
    assert list(words_of("motorCurrent_1 raw")) == ["motor", "current", "1", "raw"]


@pytest.mark.parametrize(
    ("name", "stamps", "unit", "assumed"),
    [
        ("t_ms", T * 1e3, "ms", False),
        ("Time [us]", T * 1e6, "us", False),
        ("timestamp", T, "s", True),
        ("log.ts", T, "s", True),
        ("Uhrzeit [s]", T, "s", False),
        ("epoch", 1.7e9 + T, "s", True),
        ("ts", 1.7e12 + T * 1e3, "ms", True),
        ("stamp", 1.7e18 + T * 1e9, "ns", True),
    ],
)
def test_time_is_found_by_its_name(name, stamps, unit, assumed):
    found = time_found(columns(**{"q": T**2, name: stamps}))
    assert (found.column, found.unit, found.assumed, found.even) == (name, unit, assumed, True)
    assert found.step == pytest.approx(0.002, rel=1e-3)


def test_of_two_columns_in_seconds_the_one_that_is_named_time_is_time():
    found = time_found(columns(**{"t [s]": T, "delay [s]": T**2 + T}))
    assert found.column == "t [s]"
    with pytest.raises(RecordError, match=r"several columns look like time: clock \[s\], delay \[s\]"):
        time_found(columns(**{"clock [s]": T, "delay [s]": T**2 + T}))


def test_uneven_stamps_are_told():
    jitter = np.where(np.arange(200) % 3, 0.0, 4e-4)
    found = time_found(columns(t=T + jitter))
    assert not found.even
    assert found.step == pytest.approx(0.002, rel=0.3)


def test_dates_are_time_where_no_name_says_so():
    table = Columns(Path("run.csv"), {"when": T, "q": T**2}, {}, frozenset({"when"}))
    assert time_found(table).column == "when"
    assert [one.name for one in columns_found(table)] == ["q"]


@pytest.mark.parametrize(
    ("table", "line"),
    [
        ({"q": T**2, "u": T}, "no column is called time: q, u; u rises evenly, as time does$"),
        ({"q": np.sin(T), "u": np.cos(T)}, "no column is called time: q, u$"),
        ({"t": T, "time": T + 1}, "several columns look like time: t, time$"),
        (
            {"time [samples]": np.arange(200.0)},
            r"time column 'time \[samples\]' is in samples; allowed: s",
        ),
        ({"t": T[::-1].copy()}, "time runs backward"),
        ({"t": np.where(T[5] == T, np.nan, T)}, "cannot be time: stamps are missing"),
    ],
)
def test_what_cannot_be_time_is_one_line(table, line):
    with pytest.raises(RecordError, match=line):
        time_found(columns(**table))


def test_columns_that_agree_are_one_time_axis():
    found = time_found(columns(t=T, time=T, q=T**2))
    assert (found.column, found.same) == ("t", ("time",))


def test_a_rate_needs_no_column():
    found = time_found(columns(q=T), step=0.01)
    assert (found.column, found.step, found.even) == (None, 0.01, True)


def test_constants_and_held_signals_are_told_apart():
    found = {one.name: one for one in columns_found(columns(
        still=np.ones(200), held=np.repeat(np.arange(20.0), 10), free=np.sin(T), short=np.ones(3),
    ))}  # fmt: skip
    assert set(found) == {"still", "held", "free"}
    assert [found[name].constant for name in ("still", "held", "free")] == [True, False, False]
    assert [found[name].held for name in ("still", "held", "free")] == [False, True, False]


@pytest.mark.parametrize(
    ("column", "unit", "says"),
    [("t_ms", "s", "ms"), ("t [us]", "ms", "us"), ("t_ms", "ms", ""), ("time", "s", ""), ("ts_m", "s", "")],
)
def test_a_header_that_names_another_unit_of_time_is_told(column, unit, says):
    said = other_unit_of_time(TimeMap(column, unit))
    assert said == (
        f"time is read in {unit}, but its column {column!r} says {says}: is signals.time.unit right?"
        if says
        else ""
    )
