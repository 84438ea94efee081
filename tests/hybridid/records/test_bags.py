"""Bags of ROS 2, MCAP and SQLite: each number a column, stamps of each topic, and bounds on what is read."""

from __future__ import annotations

import sqlite3
import struct
from contextlib import closing
from dataclasses import dataclass
from types import SimpleNamespace

import numpy as np
import pytest

from hybridid.records import bag_records, bags
from hybridid.records.channel import RecordError
from hybridid.records.mapping import build_record, record_map
from hybridid.records.readers import read_columns

mcap = pytest.importorskip("mcap", reason="needs the extra ros: pip install 'hybridid[ros]'")
ros2 = pytest.importorskip("mcap_ros2.writer", reason="needs the extra ros: pip install 'hybridid[ros]'")

HEADER = "\n".join(
    (
        "=" * 80,
        "MSG: std_msgs/Header",
        "builtin_interfaces/Time stamp",
        "string frame_id",
        "=" * 80,
        "MSG: builtin_interfaces/Time",
        "int32 sec",
        "uint32 nanosec",
    )
)
JOINT = f"std_msgs/Header header\nstring[] name\nfloat64[] position\nfloat64[] effort\n{HEADER}"
FLOAT = "float64 data"
EPOCH = 1_700_000_000_000_000_000
"""ns; the first stamp of every file here."""


def joint(time, q, tau, name=("elbow",), stamped=True):
    ns = EPOCH + round(time * 1e9) if stamped else 0
    stamp = SimpleNamespace(sec=ns // 10**9, nanosec=ns % 10**9)
    header = SimpleNamespace(stamp=stamp, frame_id="base")
    return SimpleNamespace(header=header, name=list(name), position=list(q), effort=list(tau))


@dataclass
class Bag:
    """Writes messages ``(topic, type, definition, message, log time in s)`` with the library's own writer."""

    path: object
    compression: object = None

    def write(self, messages):
        from mcap.writer import CompressionType

        packed = self.compression or CompressionType.ZSTD
        with self.path.open("wb") as file, ros2.Writer(file, compression=packed, chunk_size=4096) as writer:
            known = {}
            for topic, kind, text, message, at in messages:
                schema = known.setdefault(kind, None) or writer.register_msgdef(kind, text)
                known[kind] = schema
                writer.write_message(topic, schema, message, log_time=EPOCH + round(at * 1e9))
        return self.path


def swing(n=200, dt=0.01, late=0.003, stamped=True):
    """Joint states at even header stamps, logged late; a command at a third of the rate, without header."""
    for k in range(n):
        t = k * dt
        message = joint(t, [np.sin(t), 2.0], [np.cos(t), 3.0], ("elbow", "wrist"), stamped)
        yield "/joint_states", "sensor_msgs/JointState", JOINT, message, t + late
        if k % 3 == 0:
            yield "/cmd", "std_msgs/Float64", FLOAT, SimpleNamespace(data=np.sin(t)), t + 0.001


@pytest.fixture
def bag(tmp_path):
    return Bag(tmp_path / "swing.mcap")


def test_each_number_of_a_message_is_a_column(bag):
    columns = read_columns(bag.write(swing()))
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
    columns = read_columns(bag.write(swing(stamped=False)))
    np.testing.assert_allclose(np.diff(columns["/joint_states.stamp"]), 0.01, atol=1e-9)
    assert columns["/joint_states.stamp"][0] == pytest.approx(0.002), "the command was logged first"


@pytest.mark.parametrize("compression", ["NONE", "LZ4", "ZSTD"])
def test_packed_or_not(bag, compression):
    from mcap.writer import CompressionType

    columns = read_columns(Bag(bag.path, CompressionType[compression]).write(swing()))
    assert len(columns["/cmd.data"]) == 67


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
    path = bag.write(swing())
    effort = {"torque": {"column": "/joint_states.effort[0]", "unit": "N·m"}}
    record = made(path, inputs=effort)
    assert (record.n, record.provenance) == (200, "measured")
    np.testing.assert_allclose(record.input("torque"), np.cos(record.time), atol=1e-8)


def test_topics_with_other_stamps_are_refused_with_the_key_that_aligns_them(bag):
    path = bag.write(swing())
    with pytest.raises(
        RecordError,
        match=r"signal 'torque' is stamped by /cmd.stamp \(67 samples\), time is /joint_states.stamp "
        r"\(200\): set signals.resample=0.01 .*records.swing.resample",
    ):
        made(path)


@pytest.mark.parametrize("hold", ["zoh", "foh"])
def test_resampling_aligns_topics(bag, hold):
    """Each signal goes from its own stamps to the common grid: a command by its course between samples."""
    path = bag.write(swing(600))
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
    late = [(*one[:4], one[4] + (100 if one[0] == "/cmd" else 0)) for one in swing()]
    with pytest.raises(RecordError, match="no time in common"):
        made(bag.write(late), resample=0.01)


def test_time_must_be_stamps_where_topics_differ(bag):
    path = bag.write(swing())
    with pytest.raises(RecordError, match=r"set time.column to stamps, as /joint_states.stamp"):
        made(path, time={"column": "/joint_states.header.stamp.nanosec", "unit": "ns"}, resample=0.01)


def test_joints_that_change_their_order_are_refused(bag):
    messages = list(swing())
    swapped = joint(2.0, [2.0, 1.0], [3.0, 1.0], ("wrist", "elbow"))
    messages.append(("/joint_states", "sensor_msgs/JointState", JOINT, swapped, 2.0))
    columns = read_columns(bag.write(messages))
    with pytest.raises(RecordError, match=r"its names are \['wrist', 'elbow'\] at message 200"):
        columns["/joint_states.position[0]"]


def test_lists_whose_length_changes_are_refused(bag):
    messages = list(swing())
    messages.append(("/joint_states", "s/J", JOINT, joint(2.0, [1.0], [1.0], ("elbow", "wrist")), 2.0))
    columns = read_columns(bag.write(messages))
    with pytest.raises(RecordError, match="message 200 does not have it"):
        columns["/joint_states.position[1]"]


def test_images_are_left_out_and_long_lists_are_told(bag):
    messages = [*swing(20)]
    for size, topic in ((70_000, "/camera"), (300, "/scan")):
        message = SimpleNamespace(data=bytes(size))
        messages += [(topic, "x/Image", "uint8[] data", message, 0.01 * k) for k in range(12)]
    columns = read_columns(bag.write(messages))
    assert columns.unusable["/camera"].startswith("a message of it has 70,0")
    with pytest.raises(RecordError, match="it is a list of 300, at most 256"):
        columns["/scan.data"]
    assert len(columns["/joint_states.stamp"]) == 20


def test_a_file_that_is_cut_off_or_no_bag_is_told_in_one_line(bag, tmp_path):
    whole = bag.write(swing()).read_bytes()
    (tmp_path / "half.mcap").write_bytes(whole[: len(whole) // 2])
    (tmp_path / "text.mcap").write_text("t,q\n0,1\n")
    for name, said in (("half", "ends in the middle|not a readable"), ("text", "not a readable .mcap file")):
        with pytest.raises(RecordError, match=said) as told:
            read_columns(tmp_path / f"{name}.mcap")
        assert "\n" not in str(told.value)


@pytest.mark.parametrize("compression", ["zstd", "lz4"])
def test_a_chunk_that_unpacks_to_more_than_it_may_is_refused(tmp_path, monkeypatch, compression):
    """A bomb: few bytes that say that they are few, and unpack to many."""
    import lz4.frame
    import zstandard
    from mcap.records import Chunk
    from mcap.writer import Writer

    monkeypatch.setattr(bag_records, "LARGEST_CHUNK", 100_000)
    pack = {"zstd": zstandard.ZstdCompressor().compress, "lz4": lz4.frame.compress}[compression]
    bomb = Chunk(
        compression=compression,
        data=pack(bytes(10_000_000)),
        message_end_time=0,
        message_start_time=0,
        uncompressed_crc=0,
        uncompressed_size=100,
    )
    path = tmp_path / "bomb.mcap"
    with path.open("wb") as file:
        writer = Writer(file)
        writer.start()
        writer.finish()
    content = path.read_bytes()
    body = struct.pack("<QQQI", 0, 0, 100, 0)
    body += struct.pack("<I", len(compression)) + compression.encode()
    body += struct.pack("<Q", len(bomb.data)) + bomb.data
    at = 8 + 9 + struct.unpack("<Q", content[9:17])[0]
    path.write_bytes(content[:at] + b"\x06" + struct.pack("<Q", len(body)) + body + content[at:])
    with pytest.raises(RecordError, match="a chunk of more than 100,000 bytes"):
        read_columns(path)


def test_more_numbers_than_are_kept_are_refused(bag, monkeypatch):
    monkeypatch.setattr(bags, "MOST_NUMBERS", 100)
    with pytest.raises(RecordError, match="more than 100 numbers: leave topics out, with mcap filter"):
        read_columns(bag.write(swing()))


def test_a_definition_that_holds_itself_ends_in_one_line(bag):
    from mcap.writer import CompressionType

    messages = [("/a", "x/A", "float64 data", SimpleNamespace(data=1.0), 0.01 * k) for k in range(20)]
    path = Bag(bag.path, CompressionType.NONE).write(messages)
    endless = path.read_bytes().replace(b"float64 data", b"x/A     data")
    path.write_bytes(endless)
    with pytest.raises(RecordError, match="it holds no column of numbers"):
        read_columns(path)
    assert "a message of it cannot be read: maximum recursion depth" in dict(bags.read_bag(path))["/a"]


def as_database(path):
    """The bag of an MCAP file in the tables of rosbag2_storage_sqlite3, as since ROS 2 Iron."""
    from mcap.reader import make_reader

    target = path.with_suffix(".db3")
    with path.open("rb") as file, closing(sqlite3.connect(target)) as bag, bag:
        bag.executescript(
            "CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL,"
            " serialization_format TEXT NOT NULL, offered_qos_profiles TEXT NOT NULL);"
            "CREATE TABLE message_definitions(id INTEGER PRIMARY KEY, topic_type TEXT NOT NULL,"
            " encoding TEXT NOT NULL, encoded_message_definition TEXT NOT NULL);"
            "CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL,"
            " timestamp INTEGER NOT NULL, data BLOB NOT NULL);"
        )
        for schema, channel, message in make_reader(file).iter_messages():
            definition = (schema.id, schema.name, schema.encoding, schema.data.decode())
            bag.execute("INSERT OR IGNORE INTO message_definitions VALUES (?, ?, ?, ?)", definition)
            topic = (channel.id, channel.topic, schema.name, channel.message_encoding)
            bag.execute("INSERT OR IGNORE INTO topics VALUES (?, ?, ?, ?, '')", topic)
            row = (channel.id, message.log_time, message.data)
            bag.execute("INSERT INTO messages (topic_id, timestamp, data) VALUES (?, ?, ?)", row)
    return target


@pytest.fixture
def database(bag):
    return as_database(bag.write(swing()))


def test_a_database_has_the_columns_that_the_mcap_file_of_its_messages_has(bag, database):
    packed, plain = read_columns(bag.path), read_columns(database)
    assert set(plain) == set(packed)
    assert plain.instants == packed.instants
    for name in packed:
        np.testing.assert_array_equal(plain[name], packed[name])
    np.testing.assert_array_equal(plain["/cmd.data"], np.sin(np.arange(0, 200, 3) * 0.01))


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (
            "DROP TABLE message_definitions",
            "lacks message definitions, as before ROS 2 Iron: .*ros2 bag convert",
        ),
        ("DROP TABLE messages", "it has no table messages of topic_id, timestamp, data"),
        (
            "DROP TABLE messages; CREATE VIEW messages AS WITH RECURSIVE n(k) AS "
            "(SELECT 0 UNION ALL SELECT k + 1 FROM n) "
            "SELECT 1 AS topic_id, k AS timestamp, x'00' AS data FROM n",
            "it has no table messages",
        ),
        ("UPDATE messages SET data = x'28b52ffd00'", "packed by zstd: .*ros2 bag convert"),
        ("UPDATE messages SET topic_id = 9", "a message is of channel 9, which it lacks"),
        ("UPDATE messages SET data = 'text'", "not a readable .db3 file"),
    ],
)
def test_a_database_that_is_no_bag_with_definitions_is_told_in_one_line(database, change, said):
    with closing(sqlite3.connect(database)) as bag, bag:
        bag.executescript(change)
    with pytest.raises(RecordError, match=said) as told:
        read_columns(database)
    assert "\n" not in str(told.value)


def test_a_database_that_is_still_recorded_or_cut_off_is_refused(database, tmp_path):
    (tmp_path / "half.db3").write_bytes(database.read_bytes()[:9000])
    with pytest.raises(RecordError, match=r"not a readable \.db3 file"):
        read_columns(tmp_path / "half.db3")
    database.with_name("swing.db3-wal").write_bytes(b"more")
    with pytest.raises(
        RecordError, match=r"its last messages are in swing\.db3-wal: end its recording first"
    ):
        read_columns(database)


def test_bags_of_ros_1_say_how_they_become_one(tmp_path):
    (tmp_path / "old.bag").write_bytes(b"#ROSBAG V2.0")
    with pytest.raises(RecordError, match=r".bag is not read: write it as an MCAP file .*rosbags-convert"):
        read_columns(tmp_path / "old.bag")


def test_without_the_extra_one_line_says_how_to_install_it(bag, monkeypatch):
    import sys

    path = bag.write(swing(20))
    monkeypatch.setitem(sys.modules, "mcap.exceptions", None)
    with pytest.raises(RecordError, match=r"needs the extra ros: pip install 'hybridid\[ros\]'"):
        read_columns(path)


def test_messages_of_another_kind_are_told(tmp_path):
    from mcap.writer import Writer

    path = tmp_path / "other.mcap"
    with path.open("wb") as file:
        writer = Writer(file)
        writer.start()
        schema = writer.register_schema("x", "jsonschema", b"{}")
        channel = writer.register_channel("/a", "json", schema)
        writer.add_message(channel, 0, b"{}", 0)
        writer.finish()
    with pytest.raises(RecordError, match="it holds no column of numbers"):
        read_columns(path)
    said = dict(bags.read_bag(path))["/a"]
    assert said == "its messages are json, defined in jsonschema; cdr, defined in ros2msg, is read"


def test_what_is_damaged_is_refused_or_read_but_never_breaks(bag):
    """Some hundred bytes at random places, in a file whose chunks are not packed."""
    from mcap.writer import CompressionType

    path = Bag(bag.path, CompressionType.NONE).write(swing(30))
    whole, rng = path.read_bytes(), np.random.default_rng(0)
    outcomes = set()
    for _ in range(150):
        damaged = bytearray(whole)
        for place in rng.integers(0, len(whole), 3):
            damaged[place] = rng.integers(0, 256)
        path.write_bytes(bytes(damaged))
        try:
            outcomes.add(len(read_columns(path)) > 0)
        except RecordError:
            outcomes.add(False)
    assert outcomes == {True, False}


def test_the_template_reads_a_bag_whose_topics_have_stamps_of_their_own(bag):
    from hybridid.records.survey import columns_found, time_found

    columns = read_columns(bag.write(swing()))
    assert time_found(columns).column == "/joint_states.stamp"
    assert {"/cmd.data", "/joint_states.position[0]"} <= {one.name for one in columns_found(columns)}


def test_a_topic_that_cannot_be_read_leaves_the_others_readable(bag, capfd):
    from mcap.writer import CompressionType

    messages = [*swing(20)]
    messages += [("/odd", "x/Odd", "float64 odd", SimpleNamespace(odd=1.0), 0.01 * k) for k in range(5)]
    path = Bag(bag.path, CompressionType.NONE).write(messages)
    path.write_bytes(path.read_bytes().replace(b"float64 odd", b"float64 O+d"))
    columns = read_columns(path)
    assert columns.unusable["/odd"].startswith("its definition cannot be read: 'O+d' is an invalid")
    assert len(columns["/joint_states.stamp"]) == 20
    assert capfd.readouterr() == ("", "")
