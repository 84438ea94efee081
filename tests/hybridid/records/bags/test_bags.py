"""Bags of ROS 2: each number a column, stamps of each topic, and records of several topics."""

from __future__ import annotations

import numpy as np
import pytest

from hybridid.records.channel import RecordError
from hybridid.records.mapping import build_record, record_map
from hybridid.records.readers import read_columns


def test_each_number_of_a_message_is_a_column(bag):
    columns = read_columns(bag.write(bag.swing()))
    time = np.arange(200) * 0.01
    np.testing.assert_array_equal(columns["/joint_states.position[0]"], np.sin(time))
    np.testing.assert_array_equal(columns["/joint_states.effort[1]"], np.full(200, 3.0))
    np.testing.assert_array_equal(columns["/cmd.data"], np.sin(time[::3]))
    np.testing.assert_allclose(columns["/joint_states.stamp"], time, atol=1e-9)
    np.testing.assert_allclose(columns["/cmd.stamp"], time[::3] + 0.001, atol=1e-9)
    assert columns.instants == {"/joint_states.stamp", "/cmd.stamp"}
    with pytest.raises(RecordError, match="cannot be a signal: it holds the text 'base'"):
        columns["/joint_states.header.frame_id"]
    with pytest.raises(
        RecordError, match=r"'/joint_states.position' has 2 parts, .*\[0\] to .*\[1\]: name one"
    ):
        columns["/joint_states.position"]
    with pytest.raises(RecordError, match=r"did you mean '/joint_states.position\[0\]'"):
        columns["/joint_state.position[0]"]


def test_log_times_stand_in_for_headers_that_are_not_set(bag):
    columns = read_columns(bag.write(bag.swing(stamped=False)))
    np.testing.assert_allclose(np.diff(columns["/joint_states.stamp"]), 0.01, atol=1e-9)
    assert columns["/joint_states.stamp"][0] == pytest.approx(0.002), "the command was logged first"


@pytest.mark.parametrize("compression", ["NONE", "LZ4", "ZSTD"])
def test_packed_or_not(bag, compression):
    columns = read_columns(bag.write(bag.swing(), compression))
    assert len(columns["/cmd.data"]) == 67


def test_the_template_reads_a_bag_whose_topics_have_stamps_of_their_own(bag):
    from hybridid.records.survey import columns_found, time_found

    columns = read_columns(bag.write(bag.swing()))
    assert time_found(columns).column == "/joint_states.stamp"
    assert {"/cmd.data", "/joint_states.position[0]"} <= {one.name for one in columns_found(columns)}


PLAN = {
    "files": "swing.mcap",
    "time": {"column": "/joint_states.stamp"},
    "inputs": {"torque": {"column": "/cmd.data", "unit": "N·m", "hold": "zoh"}},
    "outputs": {"angle": {"column": "/joint_states.position[0]", "unit": "rad"}},
}


def made(path, **changed):
    plan = record_map({**PLAN, **changed}, "record swing")
    return build_record("swing", [path], plan.time, plan.inputs, plan.outputs, (), plan.resample)


def test_one_topic_is_a_record_as_any_other(bag):
    path = bag.write(bag.swing())
    effort = {"torque": {"column": "/joint_states.effort[0]", "unit": "N·m"}}
    record = made(path, inputs=effort)
    assert (record.n, record.provenance) == (200, "measured")
    np.testing.assert_allclose(record.input("torque"), np.cos(record.time), atol=1e-8)


def test_topics_with_other_stamps_are_refused_with_the_key_that_aligns_them(bag):
    path = bag.write(bag.swing())
    with pytest.raises(
        RecordError,
        match=r"signal 'torque' is stamped by /cmd.stamp \(67 samples\), time is /joint_states.stamp "
        r"\(200\): set signals.resample=0.01 .*records.swing.resample",
    ):
        made(path)


@pytest.mark.parametrize("hold", ["zoh", "foh"])
def test_resampling_aligns_topics(bag, hold):
    """Each signal goes from its own stamps to the common grid: a command by its course between samples."""
    path = bag.write(bag.swing(600))
    torque = {"torque": {"column": "/cmd.data", "unit": "N·m", "hold": hold}}
    record = made(path, inputs=torque, resample=0.005)
    np.testing.assert_allclose(record.output("angle"), np.sin(record.time), atol=1e-4)
    if hold == "foh":
        np.testing.assert_allclose(record.input("torque"), np.sin(record.time - 0.001), atol=1e-3)
        return
    at = record.time + 0.0025  # the middle of each step
    last = np.floor((at - 0.001) / 0.03) * 0.03
    inside = np.abs(np.mod(at - 0.001, 0.03) - 0.015) < 0.0124  # steps without a change
    np.testing.assert_allclose(record.input("torque")[inside], np.sin(last[inside]), atol=1e-9)
    assert record.time[-1] == pytest.approx(5.985, abs=0.011), "a held command does not end the record"


def test_topics_that_have_no_time_in_common_are_told(bag):
    late = [(*one[:4], one[4] + (100 if one[0] == "/cmd" else 0)) for one in bag.swing()]
    with pytest.raises(RecordError, match="no time in common"):
        made(bag.write(late), resample=0.01)


def test_time_must_be_stamps_where_topics_differ(bag):
    path = bag.write(bag.swing())
    with pytest.raises(RecordError, match=r"set time.column to stamps, as /joint_states.stamp"):
        made(path, time={"column": "/joint_states.header.stamp.nanosec", "unit": "ns"}, resample=0.01)
