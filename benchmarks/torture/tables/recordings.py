"""Recordings that are wrong in one place, in every format that is read."""

from __future__ import annotations

import datetime
import json
import os
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.torture.case import BORNE, REFUSED, Case, Content
from benchmarks.torture.lab import CASE, csv, fit, swing

FILE = "lab/swing.csv"
T, TORQUE, ANGLE = swing().T
TEXT = csv(swing())
N = len(T)
SAMPLES = [{"t": float(t), "torque": float(u), "angle": float(y)} for t, u, y in swing()]
SUFFIXES = (".mat", ".parquet", ".json", ".csv", ".npz", ".npy", ".h5", ".xlsx", ".txt", ".tdms", ".mf4", "")

CSV: Mapping[str, Content] = {
    "nothing": "",
    "empty lines": "\n\n\n",
    "a header alone": "t,torque,angle\n",
    "one sample": csv(swing()[:1]),
    "two samples": csv(swing()[:2]),
    "bytes of every value": bytes(range(256)) * 20,
    "bytes of zero": TEXT.encode()[:200] + b"\0" * 100 + TEXT.encode()[200:],
    "a quote that does not end": f'"t,torque,angle\n{TEXT}',
    "a row that is too long": f"{TEXT}1,2,3,4,5,6\n",
    "a row that is too short": f"{TEXT}1,2\n",
    "two decimal signs": TEXT.replace(",", ";").replace("0.0", "0,0"),
    "a web page": "<html><body>404</body></html>",
    "JSON": '{"a": 1}',
    "a line of 200,000 digits": "t,torque,angle\n" + "9" * 200_000 + "\n",
    "5,000 other columns": (",".join(f"c{k}" for k in range(5000)) + "\n")
    + (",".join(["1"] * 5000) + "\n") * 20,
    "one complex number": TEXT.replace("\n0,", "\n1+2j,", 1),
    "one date": TEXT.replace("\n0,", "\n2024-01-01 00:00:00,", 1),
    "a column twice": csv(swing(), "t,angle,angle"),
    "time that runs backwards": csv(np.column_stack([T[::-1], TORQUE, ANGLE])),
    "samples in no order": csv(swing()[np.random.default_rng(0).permutation(N)]),
    "no number at all": csv(np.full((N, 3), np.nan)),
}
"""CSV that cannot be a recording."""
SOUND: Mapping[str, Content] = {
    "ten samples": csv(swing()[:10]),
    "eleven samples": csv(swing()[:11]),
    "a byte order mark": "\ufeff" + TEXT,
    "UTF-16": TEXT.encode("utf-16"),
    "semicolons": TEXT.replace(",", ";"),
    "decimal commas": TEXT.replace(",", ";").replace(".", ","),
    "comments": f"# made by x\n# y\n{TEXT}",
    "lines that end as on Windows": TEXT.replace("\n", "\r\n"),
    "lines that end as on an old Mac": TEXT.replace("\n", "\r"),
    "true and false": "t,torque,angle\n"
    + "".join(f"{0.02 * k},{k % 2 == 0},{k % 3 == 0}\n" for k in range(100)),
}
"""CSV that is odd, and can be read."""


def _mat(**variables: Any) -> Callable[[Path], None]:
    def write(path: Path) -> None:
        from scipy.io import savemat

        savemat(path, {"t": T, "angle": ANGLE, **variables})

    return write


def _half_a_mat(path: Path) -> None:
    _mat(torque=TORQUE)(path)
    content = path.read_bytes()
    path.write_bytes(content[: len(content) // 2])


def _cells(count: int) -> Any:
    cells = np.empty((count, 1), object)
    for k in range(count):
        cells[k, 0] = np.arange(k % 50 + 1.0)
    return cells


def _parquet(torque: Any) -> Callable[[Path], None]:
    def write(path: Path) -> None:
        import pandas as pd

        pd.DataFrame({"t": T, "torque": torque, "angle": ANGLE}).to_parquet(path)

    return write


MAT: Mapping[str, Content] = {
    "cells": _mat(torque=_cells(50)),
    "2,000 cells": _mat(torque=_cells(2000)),
    "a structure": _mat(torque={"a": TORQUE, "b": ANGLE}),
    "an array of structures": _mat(torque=np.array([(1.0, 2.0)] * 2, dtype=[("a", "f8"), ("b", "f8")])),
    "text": _mat(torque="hello"),
    "complex numbers": _mat(torque=TORQUE + 1j),
    "three dimensions": _mat(torque=TORQUE.reshape(5, 5, 6)),
    "nothing in it": _mat(torque=np.zeros((0, 0))),
    "a matrix": _mat(torque=np.column_stack([TORQUE, TORQUE])),
    "a sample less": _mat(torque=TORQUE[:-1]),
    "its second half cut off": _half_a_mat,
    "the header of version 7.3 alone": b"MATLAB 7.3 MAT-file".ljust(128) + b"\x89HDF\r\n\x1a\n" + b"x" * 500,
}
PARQUET: Mapping[str, Content] = {
    "text": _parquet(["a"] * N),
    "lists": _parquet([[1.0, 2.0]] * N),
    "lists of 2,000": _parquet([list(range(2000))] * N),
    "mappings": _parquet([{"a": 1}] * N),
    "nothing": _parquet([None] * N),
    "a gap": _parquet([None, *TORQUE[1:]]),
    "dates": _parquet([datetime.datetime(2024, 1, 1, tzinfo=datetime.UTC)] * N),
    "durations": _parquet([datetime.timedelta(seconds=1)] * N),
}
JSON: Mapping[str, Content] = {
    name: json.dumps(content)
    for name, content in {
        "null": [*SAMPLES[:4], {"t": None, "torque": None, "angle": None}, *SAMPLES[5:]],
        "a text": "abc",
        "a number": 3,
        "an empty list": [],
        "an empty object": {},
        "an object in an object": {"a": {"b": [1, 2]}},
        "a number among samples": [1, {"t": 1}],
        "lists of numbers": [[1, 2, 3]] * 20,
        "a sample that lacks a name": [*SAMPLES[:5], {"t": 1.0}, *SAMPLES[6:]],
        "a whole number of 400 digits": [{**one, "torque": 10**400} for one in SAMPLES],
        "texts of 5,000 characters": [{**one, "torque": "x" * 5000} for one in SAMPLES],
        "NaN": [{**one, "torque": float("nan")} for one in SAMPLES],
    }.items()
} | {"100,000 lists in each other": "[" * 100_000 + "]" * 100_000}
ODD_PARQUET = _parquet([b"1"] * N)
WHOLE: Mapping[str, Content] = {
    ".mat": _mat(torque=TORQUE > 0),
    ".parquet": _parquet(TORQUE),
    ".json": json.dumps(SAMPLES),
}


def _instead(make: Callable[[Path], object]) -> Callable[[Path], None]:
    def write(path: Path) -> None:
        path.unlink()
        make(path)

    return write


PLACES: Mapping[str, Content] = {
    "that is gone": Path.unlink,
    "that is a folder": _instead(Path.mkdir),
    "that is a link to itself": _instead(lambda path: path.symlink_to("swing.csv")),
    "that is a pipe": _instead(os.mkfifo),
    "that is an endless device": _instead(lambda path: path.symlink_to("/dev/zero")),
}
NAMES: Mapping[str, str] = {
    "a line break": '"a\\nb.csv"',
    "a byte of zero": '"a\\0b.csv"',
    "5,000 characters": "x" * 5000 + ".csv",
}
RECORD_NAMES: Mapping[str, str] = {
    "that leads elsewhere": "../../evil",
    "that is empty": '""',
    "that is a dot": '"."',
    "of 300 characters": "x" * 300,
}


def cases() -> Iterator[tuple[str, Case]]:
    """Each with its category."""
    tables = ((".csv", CSV), (".mat", MAT), (".parquet", PARQUET), (".json", JSON))
    for suffix, table in tables:
        for name, content in table.items():
            yield _case(f"{suffix} with {name}", _other(suffix, content))
    for suffix in SUFFIXES:
        yield _case(f"nonsense in a file {suffix or 'without suffix'}", _other(suffix, b"garbage" * 30))
        yield _case(f"nothing in a file {suffix or 'without suffix'}", _other(suffix, b""))
    for what, content in PLACES.items():
        yield _case(f"a file {what}", {FILE: content})
    for what, name in NAMES.items():
        yield _case(f"a file whose name has {what}", _in_case("swing.csv", name))
    for what, name in RECORD_NAMES.items():
        yield _case(f"a record name {what}", _in_case("swing:", f"{name}:"))
    for name, content in SOUND.items():
        yield _case(f".csv with {name}", {FILE: content}, BORNE)
    yield _case(".parquet with bytes", _other(".parquet", ODD_PARQUET), BORNE)
    for suffix, content in WHOLE.items():
        yield _case(f"{suffix} that is whole", _other(suffix, content), BORNE)
    odd = {**_in_case("swing.csv", "schwüng ☃.csv"), "lab/schwüng ☃.csv": TEXT}
    yield _case("a file whose name has odd letters", odd, (0,))
    yield _case("a record name of odd letters", _in_case("swing:", '"größe ☃ /":'), BORNE)


def _case(name: str, files: Mapping[str, Content], codes: tuple[int, ...] = REFUSED) -> tuple[str, Case]:
    return "recordings by hand", Case(f"recording: {name}", tuple(fit()), (), codes, files)


def _other(suffix: str, content: Content) -> dict[str, Content]:
    return {**_in_case("swing.csv", f"swing{suffix}"), f"lab/swing{suffix}": content}


def _in_case(old: str, new: str) -> dict[str, Content]:
    return {"lab/case/mine.yaml": CASE.replace(old, new)}
