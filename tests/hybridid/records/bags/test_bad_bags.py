"""MCAP files that are damaged, too large, or hold what is no column: refused in one line, or left out."""

from __future__ import annotations

import struct
import sys
from types import SimpleNamespace

import numpy as np
import pytest

from hybridid.records import bag_records, bags
from hybridid.records.channel import RecordError
from hybridid.records.readers import read_columns

pytest.importorskip("mcap", reason="needs the extra ros: pip install 'hybridid[ros]'")


def test_joints_that_change_their_order_are_refused(bag):
    messages = list(bag.swing())
    swapped = bag.joint(2.0, [2.0, 1.0], [3.0, 1.0], ("wrist", "elbow"))
    messages.append(("/joint_states", "sensor_msgs/JointState", bag.JOINT, swapped, 2.0))
    columns = read_columns(bag.write(messages))
    with pytest.raises(RecordError, match=r"its names are \['wrist', 'elbow'\] at message 200"):
        columns["/joint_states.position[0]"]


def test_lists_whose_length_changes_are_refused(bag):
    messages = list(bag.swing())
    messages.append(
        ("/joint_states", "s/J", bag.JOINT, bag.joint(2.0, [1.0], [1.0], ("elbow", "wrist")), 2.0)
    )
    columns = read_columns(bag.write(messages))
    with pytest.raises(RecordError, match="message 200 does not have it"):
        columns["/joint_states.position[1]"]


def test_images_are_left_out_and_long_lists_are_told(bag):
    messages = [*bag.swing(20)]
    for size, topic in ((70_000, "/camera"), (300, "/scan")):
        message = SimpleNamespace(data=bytes(size))
        messages += [(topic, "x/Image", "uint8[] data", message, 0.01 * k) for k in range(12)]
    columns = read_columns(bag.write(messages))
    assert columns.unusable["/camera"].startswith("a message of it has 70,0")
    with pytest.raises(RecordError, match="it is a list of 300, at most 256"):
        columns["/scan.data"]
    assert len(columns["/joint_states.stamp"]) == 20


def test_a_topic_that_cannot_be_read_leaves_the_others_readable(bag, capfd):
    messages = [*bag.swing(20)]
    messages += [("/odd", "x/Odd", "float64 odd", SimpleNamespace(odd=1.0), 0.01 * k) for k in range(5)]
    path = bag.write(messages, "NONE")
    path.write_bytes(path.read_bytes().replace(b"float64 odd", b"float64 O+d"))
    columns = read_columns(path)
    assert columns.unusable["/odd"].startswith("its definition cannot be read: 'O+d' is an invalid")
    assert len(columns["/joint_states.stamp"]) == 20
    assert capfd.readouterr() == ("", "")


def test_a_file_that_is_cut_off_or_no_bag_is_told_in_one_line(bag, tmp_path):
    whole = bag.write(bag.swing()).read_bytes()
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
        read_columns(bag.write(bag.swing()))


def test_a_definition_that_holds_itself_ends_in_one_line(bag):
    messages = [("/a", "x/A", "float64 data", SimpleNamespace(data=1.0), 0.01 * k) for k in range(20)]
    path = bag.write(messages, "NONE")
    endless = path.read_bytes().replace(b"float64 data", b"x/A     data")
    path.write_bytes(endless)
    with pytest.raises(RecordError, match="it holds no column of numbers"):
        read_columns(path)
    assert "a message of it cannot be read: maximum recursion depth" in dict(bags.read_bag(path))["/a"]


def test_bags_of_ros_1_say_how_they_become_one(tmp_path):
    (tmp_path / "old.bag").write_bytes(b"#ROSBAG V2.0")
    with pytest.raises(RecordError, match=r".bag is not read: write it as an MCAP file .*rosbags-convert"):
        read_columns(tmp_path / "old.bag")


def test_without_the_extra_one_line_says_how_to_install_it(bag, monkeypatch):
    path = bag.write(bag.swing(20))
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
    path = bag.write(bag.swing(30), "NONE")
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
