"""Whether the files of a folder are whole, and the numbers that they hold."""

from __future__ import annotations

import csv
import hashlib
import json
import re
import sqlite3
from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from contextlib import closing
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
import pyarrow.parquet
import yaml

OF_TIME = ("seconds", "began", "ended", "times", "date")
"""Keys with such a word hold no result."""
OF_THE_WAY = ("processes", "pid", "plan")
"""Keys that say how the results were come by, as what was there already and was not done again."""
NO_RESULT = ("stage.json", "plan.json", "search.json")
UNNAMED = (".unfinished-", ".replaced-", "making-", ".part", "-new")
"""Marks of names that a file has until it is whole. The next command removes such files."""
DRAWN = ("mlflow-artifacts", "mlflow-waiting")
"""Folders in which files have names that are drawn."""
RUN = "MLflow: "
SQLITE = ("-journal", "-wal", "-shm")


def half_written(folder: Path) -> Iterator[str]:
    """The files below ``folder`` that a program cannot read, by the name of a result."""
    for path in _files(folder):
        try:
            _read(path)
        except Exception as wrong:
            yield f"{path.relative_to(folder)}: {type(wrong).__name__}: {wrong}"


def left_behind(folder: Path) -> list[str]:
    """Files that have not got their names."""
    found = [p for p in folder.rglob("*") if any(mark in p.name for mark in UNNAMED) and not _of_sqlite(p)]
    return sorted(str(path.relative_to(folder)) for path in found)


def numbers(folder: Path) -> dict[str, str]:
    """A digest of the results in each file of data, and of each finished run in MLflow; not of how long they
    took."""
    found = finished_runs(folder)
    for path in _files(folder):
        if set(DRAWN) & set(path.parts):
            continue
        if path.suffix in (".json", ".parquet", ".csv", ".npz") and path.name not in NO_RESULT:
            text = json.dumps(_results(_read(path)), sort_keys=True, default=str)
            found[str(path.relative_to(folder))] = hashlib.sha256(text.encode()).hexdigest()[:16]
    return found


def how_many(found: Mapping[str, str]) -> dict[str, str]:
    """How many there are of each kind of what ``numbers`` found; trials that differ by number are a kind."""
    names = (name.rpartition(" ")[0] if name.startswith(RUN) else name for name in found)
    return {kind: str(n) for kind, n in Counter(re.sub(r"\d+", "N", name) for name in names).items()}


def contents(folder: Path) -> dict[str, str]:
    """A digest of each finished file."""
    return {
        str(path.relative_to(folder)): hashlib.sha256(path.read_bytes()).hexdigest()
        for path in _files(folder)
    }


def running_runs(folder: Path) -> list[str]:
    """The runs that MLflow holds for unfinished."""
    return [str(name) for (name,) in _asked(folder, "select name from runs where status = 'RUNNING'")]


def finished_runs(folder: Path) -> dict[str, str]:
    """A digest of the parameters and numbers of each finished run in MLflow; equal ones are one."""
    found = {}
    for uuid, name in _asked(folder, "select run_uuid, name from runs where status = 'FINISHED'"):
        said: list[tuple[Any, ...]] = [(name, None)]
        for table in ("params", "latest_metrics"):
            said += _asked(folder, f"select key, value from {table} where run_uuid = '{uuid}' order by key")
        text = json.dumps([row for row in said if not _is_no_result(str(row[0]))])
        digest = hashlib.sha256(text.encode()).hexdigest()[:16]
        found[f"{RUN}{name} {digest}"] = digest
    return found


def _asked(folder: Path, words: str) -> list[tuple[Any, ...]]:
    """The rows that MLflow's store below ``folder`` answers with."""
    store = folder / "outputs" / "mlflow.db"
    return rows(store, words) if store.exists() else []


def rows(store: Path, words: str) -> list[tuple[Any, ...]]:
    """The rows of a database."""
    with closing(sqlite3.connect(f"file:{store}?mode=ro", uri=True)) as database:
        return database.execute(words).fetchall()


def _files(folder: Path) -> list[Path]:
    """Files by the names of results: none that is hidden, and none in a folder that is."""
    found = (p for p in folder.rglob("*") if p.is_file() and not p.is_symlink())
    return sorted(
        p
        for p in found
        if not any(part.startswith((".", "making-")) for part in p.relative_to(folder).parts)
        and not _of_sqlite(p)
    )


def _of_sqlite(path: Path) -> bool:
    return path.name.endswith(SQLITE)


def _read(path: Path) -> Any:
    """What a program reads of the file.

    Raises:
        Exception: if it is not whole.
    """
    return READERS.get(path.suffix, Path.read_bytes)(path)


def _columns(path: Path) -> dict[str, list[Any]]:
    table = pyarrow.parquet.read_table(path)
    return {name: np.asarray(table[name]).tolist() for name in table.column_names}


def _arrays(path: Path) -> dict[str, list[Any]]:
    with np.load(path) as arrays:
        return {name: arrays[name].tolist() for name in arrays}


def _rows(path: Path) -> list[dict[str, str]]:
    with path.open(encoding="utf-8") as file:
        return list(csv.DictReader(file))


def _ends_in(end: bytes) -> Callable[[Path], None]:
    def check(path: Path) -> None:
        if end not in path.read_bytes()[-64:]:
            raise ValueError(f"does not end in {end.decode()}")

    return check


def _sound(path: Path) -> None:
    with closing(sqlite3.connect(f"file:{path}?mode=ro", uri=True)) as database:
        (said,) = database.execute("pragma integrity_check").fetchone()
    if said != "ok":
        raise ValueError(said)


READERS: dict[str, Callable[[Path], Any]] = {
    ".json": lambda path: json.loads(path.read_text(encoding="utf-8")),
    ".yaml": lambda path: yaml.safe_load(path.read_text(encoding="utf-8")),
    ".parquet": _columns,
    ".csv": _rows,
    ".npz": _arrays,
    ".svg": lambda path: ElementTree.parse(path).getroot().tag,
    ".html": _ends_in(b"</html>"),
    ".png": _ends_in(b"IEND"),
    ".pdf": _ends_in(b"%%EOF"),
    ".db": _sound,
}


def _results(value: Any) -> Any:
    if isinstance(value, Mapping):
        return {key: _results(below) for key, below in value.items() if not _is_no_result(str(key))}
    if isinstance(value, list):
        return [_results(item) for item in value]
    return value


def _is_no_result(key: str) -> bool:
    return key in OF_THE_WAY or any(word in key for word in OF_TIME)
