"""Bags in the database of rosbag2: the columns of an MCAP file, or one line that says why not."""

from __future__ import annotations

import sqlite3
from contextlib import closing

import numpy as np
import pytest

from hybridid.records.channel import RecordError
from hybridid.records.readers import read_columns


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
    return as_database(bag.write(bag.swing()))


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
