"""The columns of a bag of ROS 2, MCAP or SQLite: a column for each number of each topic's messages.

``/joint_states.position[0]`` is a number of a message, ``/imu.angular_velocity.z`` one of a message within.
``/joint_states.stamp`` are the topic's stamps in s since the first stamp of the file: those of the messages'
headers, or, without a header or where none is set, the times at which they were logged.

A file can be from anybody. Its message definitions are read as data and run nothing, and what it may hold is
bounded: a message, and all that is kept (``bag_records`` bounds what is unpacked).
"""

from __future__ import annotations

from array import array
from collections.abc import Callable, Iterator
from contextlib import redirect_stderr
from dataclasses import dataclass, field
from io import StringIO
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hybridid.naming import shortened
from hybridid.records.bag_records import records
from hybridid.records.channel import Array, RecordError

INSTALL = "reading bags of ROS 2 needs the extra ros: pip install 'hybridid[ros]'"
LARGEST_MESSAGE = 2**16
"""Bytes of a message: images and point clouds, which are larger, are no signals."""
LONGEST_LIST = 256
"""Numbers in a list of a message that become columns."""
MOST_NUMBERS = 50_000_000
"""Numbers that are kept of a file."""
NANO = 1e-9


@dataclass(frozen=True)
class Stamped:
    """A column (n,) whose samples are of the times in the column ``clock``."""

    values: Array
    clock: str


@dataclass(frozen=True)
class Instants:
    """A column of dates, in s since the first of them, or of durations, in s."""

    seconds: Array


def read_bag(path: Path) -> Iterator[tuple[str, Stamped | Instants | str]]:
    """The columns of the bag at ``path``, or why a topic or a column is none.

    Raises:
        RecordError: if the extra is not installed, the file is cut off, or it holds more than is read.
    """
    topics = _topics(path)
    firsts = [int(topic.stamps.min()) for topic in topics if topic.log]
    for topic in topics:
        if topic.unread or not topic.log:
            yield topic.name, topic.unread or "it has no message"
            continue
        clock = f"{topic.name}.stamp"
        order = np.argsort(np.array(topic.log), kind="stable")
        yield clock, Instants(np.asarray((topic.stamps - min(firsts))[order] * NANO, dtype=float))
        for name, values in topic.columns.items():
            if name != ".stamp":
                why = topic.why_not(name)
                yield f"{topic.name}{name}", why or Stamped(np.array(values)[order], clock)


@dataclass
class _Topic:
    """What is kept of one topic. ``names`` are those of its first message, where its messages list names."""

    name: str
    unread: str = ""
    log: array[int] = field(default_factory=lambda: array("q"))
    header: array[int] = field(default_factory=lambda: array("q"))
    columns: dict[str, array[float]] = field(default_factory=dict)
    refused: dict[str, str] = field(default_factory=dict)
    names: list[str] | None = None
    renamed: str = ""

    @property
    def stamps(self) -> NDArray[np.int64]:
        """Times (n,) in ns: the headers', or where these are not set the log's."""
        set_by_header = len(self.header) == len(self.log) and any(self.header)
        return np.array(self.header if set_by_header else self.log, dtype=np.int64)

    def take(self, message: Any, logged: int) -> int:
        """Add a decoded ``message``; returns how many numbers it has."""
        k, count = len(self.log), 0
        self.log.append(logged)
        stamp = getattr(getattr(message, "header", None), "stamp", None)
        if stamp is not None:
            self.header.append(int(stamp.sec) * 10**9 + int(stamp.nanosec))
        for name, value in _flat(message, ""):
            count += 1
            column = self.columns.setdefault(name, array("d"))
            if isinstance(value, str):
                self.refused.setdefault(name, value)
            elif len(column) == k:  # else a message before did not have it
                column.append(value)
        names = getattr(message, "name", None)
        if isinstance(names, list):
            self.names = names if self.names is None else self.names
            if names != self.names and not self.renamed:
                now, first = (shortened(str(one), 60) for one in (names, self.names))
                self.renamed = f"its names are {now} at message {k} and {first} at the first"
        return count

    def why_not(self, name: str) -> str:
        """Why a column is none; empty if it is one."""
        if name in self.refused:
            return self.refused[name]
        if len(self.columns[name]) < len(self.log):
            return f"message {len(self.columns[name])} does not have it"
        return self.renamed if name.endswith("]") else ""


def _flat(value: Any, name: str) -> Iterator[tuple[str, float | str]]:
    """The numbers in ``value`` with their names, or in words what is no number."""
    if isinstance(value, int | float):
        yield name, float(value)
    elif isinstance(value, str):
        yield name, f"it holds the text {shortened(repr(value), 40)}"
    elif isinstance(value, bytes | list | array):
        if len(value) > LONGEST_LIST:
            yield name, f"it is a list of {len(value)}, at most {LONGEST_LIST} numbers are read"
            return
        for i, one in enumerate(value):
            yield from _flat(one, f"{name}[{i}]")
    else:
        for key in value.__slots__:
            yield from _flat(getattr(value, key), f"{name}.{key}")


def _topics(path: Path) -> list[_Topic]:
    """The topics of the file, with what their messages hold."""
    try:
        from mcap.exceptions import EndOfFile
        from mcap.records import Channel, Message, Schema
        from mcap_ros2.decoder import DecoderFactory
    except ImportError as missing:
        raise RecordError(f"{path}: {INSTALL}") from missing
    factory, schemas = DecoderFactory(), {}
    topics: dict[str, _Topic] = {}
    channels: dict[int, tuple[_Topic, Callable[[bytes], Any]]] = {}
    numbers = 0
    try:
        for record in records(path):
            if isinstance(record, Schema):
                schemas[record.id] = record
            elif isinstance(record, Channel) and record.id not in channels:
                topic = topics.setdefault(record.topic, _Topic(record.topic))
                decoder = _decoder(factory, record, schemas.get(record.schema_id), topic)
                channels[record.id] = topic, decoder
            elif isinstance(record, Message):
                if record.channel_id not in channels:
                    raise RecordError(f"{path}: a message is of channel {record.channel_id}, which it lacks")
                numbers += _taken(record, *channels[record.channel_id])
            if numbers > MOST_NUMBERS:
                raise RecordError(
                    f"{path}: more than {MOST_NUMBERS:,} numbers: leave topics out, with mcap filter "
                    "or ros2 bag convert"
                )
    except EndOfFile as end:
        raise RecordError(f"{path}: it ends in the middle: was it cut off? mcap recover may help") from end
    return list(topics.values())


def _decoder(factory: Any, channel: Any, schema: Any, topic: _Topic) -> Callable[[bytes], Any]:
    """What decodes the messages of a channel; where nothing does, ``topic`` says why."""
    try:
        with redirect_stderr(StringIO()):  # the library prints what it then raises
            decoder = factory.decoder_for(channel.message_encoding, schema)
    except Exception as wrong:
        topic.unread = f"its definition cannot be read: {shortened(str(wrong), 100) or type(wrong).__name__}"
        return lambda _: None
    if decoder is None:
        topic.unread = _other(channel, schema)
    return decoder or (lambda _: None)


def _other(channel: Any, schema: Any) -> str:
    """Why the messages of a channel are not read."""
    defined = (
        f", defined in {shortened(schema.encoding, 20)}" if schema is not None and schema.encoding else ""
    )
    encoding = shortened(channel.message_encoding, 20) or "of no encoding"
    return f"its messages are {encoding}{defined}; cdr, defined in ros2msg, is read"


def _taken(record: Any, topic: _Topic, decoder: Callable[[bytes], Any]) -> int:
    """Add a message to its topic; returns how many numbers it has."""
    if topic.unread:
        return 0
    if len(record.data) > LARGEST_MESSAGE:
        topic.unread = (
            f"a message of it has {len(record.data):,} bytes, at most {LARGEST_MESSAGE:,} are read: images "
            "and point clouds are no signals"
        )
        return 0
    try:
        message = decoder(record.data)
    except Exception as wrong:  # a definition may hold what the library does not read, such as wstring
        topic.unread = f"a message of it cannot be read: {shortened(str(wrong), 100) or type(wrong).__name__}"
        return 0
    return topic.take(message, record.log_time)
