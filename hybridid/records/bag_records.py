"""The records of a bag of ROS 2: the definitions of its messages, its topics and its messages, in that order.

The library mcap reads MCAP files. ``.db3`` files, which ROS 2 wrote before, are SQLite databases with the
tables of rosbag2_storage_sqlite3 (https://github.com/ros2/rosbag2). Since ROS 2 Iron they hold the
definitions of their messages, in the same text as MCAP files, so the same library decodes them.
"""

from __future__ import annotations

import sqlite3
from collections.abc import Iterator
from contextlib import closing
from dataclasses import replace
from io import BytesIO
from pathlib import Path
from typing import Any

from hybridid.records.channel import RecordError

LARGEST_CHUNK = 2**28
"""Bytes of a chunk, packed or unpacked, and of a value in a database."""
CONVERT = "where ROS 2 is installed, ros2 bag convert writes it as MCAP"
_TABLES = {
    "topics": ("id", "name", "type", "serialization_format"),
    "messages": ("topic_id", "timestamp", "data"),
    "message_definitions": ("id", "topic_type", "encoding", "encoded_message_definition"),
}
_PACKED = b"\x28\xb5\x2f\xfd"
"""The first bytes of what zstd packed. RFC 8878, section 3.1.1."""


def records(path: Path) -> Iterator[Any]:
    """``Schema``, ``Channel`` and ``Message`` of mcap, each before the first that needs it.

    Raises:
        RecordError: if a chunk or a value is too large, or a database is no bag that holds its definitions.
    """
    return _of_database(path) if path.suffix.lower() == ".db3" else _of_mcap(path)


def _of_database(path: Path) -> Iterator[Any]:
    """The records of an SQLite database. Only tables are read: a view or a made column would compute."""
    from mcap.records import Channel, Message, Schema

    unsaved = path.with_name(f"{path.name}-wal")
    if unsaved.is_file() and unsaved.stat().st_size:
        raise RecordError(f"{path}: its last messages are in {unsaved.name}: end its recording first")
    with closing(sqlite3.connect(f"{path.absolute().as_uri()}?mode=ro&immutable=1", uri=True)) as bag:
        bag.setlimit(sqlite3.SQLITE_LIMIT_LENGTH, LARGEST_CHUNK)
        bag.execute("PRAGMA trusted_schema = OFF")
        _check(path, bag)
        definitions = {}
        for key, name, encoding, text in bag.execute(
            "SELECT id, topic_type, encoding, encoded_message_definition FROM message_definitions"
        ):
            definitions[name] = key
            yield Schema(id=key, data=text.encode(), encoding=encoding, name=name)
        for key, topic, kind, encoding in bag.execute(
            "SELECT id, name, type, serialization_format FROM topics"
        ):
            yield Channel(
                id=key,
                topic=topic,
                message_encoding=encoding,
                metadata={},
                schema_id=definitions.get(kind, 0),
            )
        for topic, stamp, data in bag.execute("SELECT topic_id, timestamp, data FROM messages"):
            if data.startswith(_PACKED):
                raise RecordError(f"{path}: its messages are packed by zstd: {CONVERT}")
            yield Message(channel_id=topic, data=data, log_time=stamp, publish_time=stamp, sequence=0)


def _check(path: Path, bag: sqlite3.Connection) -> None:
    """Raise RecordError unless the tables of a bag are there, as tables."""
    found: dict[str, set[str]] = {}
    for table, column in bag.execute(
        "SELECT one.name, part.name FROM sqlite_master AS one, pragma_table_info(one.name) AS part "
        "WHERE one.type = 'table' AND one.rootpage > 0"
    ):
        found.setdefault(table, set()).add(column)
    for table, columns in _TABLES.items():
        if not found.get(table, set()).issuperset(columns):
            if table == "message_definitions":
                raise RecordError(f"{path}: it lacks message definitions, as before ROS 2 Iron: {CONVERT}")
            raise RecordError(f"{path}: no bag of ROS 2: it has no table {table} of {', '.join(columns)}")


def _of_mcap(path: Path) -> Iterator[Any]:
    """The records of an MCAP file, those of a chunk in their places.

    The library would unpack a chunk to whatever size it says inside, so it is unpacked here.
    """
    from mcap.records import Chunk
    from mcap.stream_reader import StreamReader, breakup_chunk

    with path.open("rb") as file:
        for record in StreamReader(file, emit_chunks=True, record_size_limit=LARGEST_CHUNK).records:
            if isinstance(record, Chunk):
                yield from breakup_chunk(replace(record, compression="", data=_unpacked(path, record)))
            else:
                yield record


def _unpacked(path: Path, chunk: Any) -> bytes:
    """The bytes of a chunk."""
    import lz4.frame
    import zstandard

    if chunk.compression == "zstd":
        with zstandard.ZstdDecompressor().stream_reader(BytesIO(chunk.data)) as stream:
            found = stream.read(LARGEST_CHUNK + 1)
    elif chunk.compression == "lz4":
        found = lz4.frame.LZ4FrameDecompressor().decompress(chunk.data, max_length=LARGEST_CHUNK + 1)
    elif chunk.compression:
        raise RecordError(f"{path}: a chunk is packed by {chunk.compression!r}, allowed: zstd, lz4")
    else:
        found = chunk.data
    if len(found) > LARGEST_CHUNK:
        raise RecordError(f"{path}: a chunk of more than {LARGEST_CHUNK:,} bytes: write smaller ones")
    return bytes(found)
