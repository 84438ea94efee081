"""Recordings that Hypothesis draws: a table comes back as it was written, or is refused in one line."""

from __future__ import annotations

import csv
import io
import json
import tempfile
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np
from hypothesis import strategies as st

from benchmarks.torture.case import check_line
from hybridid.records.channel import RecordError
from hybridid.records.readers import READERS, read_columns

SEPARATORS, NEWLINES = (",", ";", "\t", "|"), ("\n", "\r\n")
ENCODINGS = ("utf-8", "utf-8-sig", "utf-16", "latin-1")
LETTERS = st.characters(
    codec="latin-1", categories=("L", "N", "P", "S", "Zs"), include_characters="\x0c\x1c\x85"
)
NAMES = st.text(LETTERS, min_size=1, max_size=12)


@dataclass(frozen=True)
class Dialect:
    """How a table is written as CSV."""

    separator: str
    decimal: str
    newline: str
    encoding: str
    header: bool
    comments: int


@st.composite
def tables(draw: st.DrawFn) -> tuple[list[str], list[list[float]], Dialect]:
    """The names of columns, rows of numbers, and how they are written."""
    separator = draw(st.sampled_from(SEPARATORS))
    decimal = draw(st.sampled_from((".",) if separator == "," else (".", ",")))
    header = draw(st.booleans())
    newline, encoding = draw(st.sampled_from(NEWLINES)), draw(st.sampled_from(ENCODINGS))
    least = 2 if decimal == "," else 1  # a lone column of 1,5 is two columns as well
    names = draw(st.lists(NAMES, min_size=least, max_size=4, unique_by=str.strip))
    row = st.lists(st.floats(), min_size=len(names), max_size=len(names))
    rows = draw(st.lists(row, min_size=1, max_size=6))
    return names, rows, Dialect(separator, decimal, newline, encoding, header, draw(st.integers(0, 2)))


def csv_of(names: list[str], rows: list[list[float]], dialect: Dialect) -> bytes:
    """The table as CSV."""
    text = io.StringIO()
    writer = csv.writer(text, delimiter=dialect.separator, lineterminator=dialect.newline)
    for k in range(dialect.comments):
        text.write(f"# comment {k}{dialect.newline}")
    if dialect.header:
        writer.writerow(names)
    for row in rows:
        writer.writerow([repr(value).replace(".", dialect.decimal) for value in row])
    return text.getvalue().encode(dialect.encoding)


def table_comes_back(drawn: tuple[list[str], list[list[float]], Dialect]) -> None:
    """A table that was written as CSV is read back number by number, or refused in a line."""
    names, rows, dialect = drawn
    columns = _read(csv_of(*drawn), ".csv")
    if columns is None:
        return
    for j, name in enumerate(names if dialect.header else [f"[{k}]" for k in range(len(names))]):
        found = columns.get(name.strip())
        if found is not None:
            assert np.array_equal(found, [row[j] for row in rows], equal_nan=True), (name, found)


def bytes_are_read_or_refused(drawn: tuple[str, bytes]) -> None:
    """Any bytes give columns of numbers, or a line."""
    suffix, content = drawn
    for values in (_read(content, suffix) or {}).values():
        assert values.dtype == float
        assert values.ndim == 1


@st.composite
def contents(draw: st.DrawFn) -> tuple[str, bytes]:
    """Bytes, or a sound file of some format in which bytes were replaced."""
    suffix = draw(st.sampled_from(sorted(READERS)))
    whole = bytearray(_sound(suffix)) if draw(st.booleans()) else bytearray(draw(st.binary(max_size=300)))
    for _ in range(draw(st.integers(0, 4))):
        start = draw(st.integers(0, len(whole)))
        whole[start : start + draw(st.integers(0, 8))] = draw(st.binary(max_size=8))
    return suffix, bytes(whole)


@cache
def _sound(suffix: str) -> bytes:
    import pandas as pd
    from scipy.io import savemat

    table = {"t": [0.0, 0.1, 0.2], "u": [1.0, 2.0, 3.0]}
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / f"sound{suffix}"
        if suffix == ".mat":
            savemat(path, {name: np.array(values) for name, values in table.items()})
        elif suffix == ".parquet":
            pd.DataFrame(table).to_parquet(path)
        elif suffix == ".mcap":
            _write_bag(path, table)
        else:
            path.write_text(json.dumps(table) if suffix == ".json" else "t;u\n0,0;1\n0,1;2\n0,2;3\n")
        return path.read_bytes()


def _write_bag(path: Path, table: Mapping[str, list[float]]) -> None:
    """A message of one topic for each sample, in chunks that are not packed: changed bytes are seen."""
    from mcap.writer import CompressionType
    from mcap_ros2.writer import Writer

    with path.open("wb") as file, Writer(file, compression=CompressionType.NONE) as bag:
        schema = bag.register_msgdef("drawn/Sample", "\n".join(f"float64 {name}" for name in table))
        for k, row in enumerate(zip(*table.values(), strict=True)):
            bag.write_message("/drawn", schema, dict(zip(table, row, strict=True)), log_time=k * 10**8)


def _read(content: bytes, suffix: str) -> Mapping[str, np.ndarray] | None:
    """The columns of a file; None if it is refused, which must be in a line."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / f"drawn{suffix}"
        path.write_bytes(content)
        try:
            return read_columns(path).values_by_name
        except RecordError as refused:
            check_line(refused)
            return None
