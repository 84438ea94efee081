"""Results as files that any program can read: strict JSON, and Parquet for time series."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from hybridid.plain import plain, restored
from hybridid.records import tables
from pipelines.shared.errors import ConfigError

T = TypeVar("T")


def write_json(path: Path, data: Any) -> None:
    """Write dataclasses, arrays and plain data as strict JSON; numbers that are not finite become null."""
    path.write_text(json_text(data), encoding="utf-8")


def json_text(data: Any) -> str:
    """The text that ``write_json`` writes."""
    return json.dumps(plain(data), indent=1, ensure_ascii=False, allow_nan=False) + "\n"


def read_json(path: Path) -> Any:
    """The content of a JSON file as plain data.

    Raises:
        ValueError: if it is no JSON in UTF-8, or nested deeper than any file of ours; it names the file.
    """
    try:
        return json.loads(path.read_text(encoding="utf-8"))
    except RecursionError as error:
        raise ValueError(f"{path}: nested too deep") from error
    except ValueError as error:
        raise ValueError(f"{path}: no JSON: {error}") from error


def read_as(cls: type[T], path: Path) -> T:
    """The content of a file from ``write_json`` as ``cls``: a dataclass, or a tuple or mapping of them.

    Raises:
        FileNotFoundError: if there is no such file.
        ConfigError: if the content does not fit ``cls``; the message names the file and the key.
    """
    return restored(cls, read_json(path), str(path), ConfigError)


def write_table(path: Path, columns: Mapping[str, NDArray[Any]], about: Mapping[str, str]) -> None:
    """Write columns of equal length as Parquet, with the notes ``about`` them in the file's metadata."""
    from pyarrow import parquet

    parquet.write_table(tables.table_of(columns).replace_schema_metadata(dict(about)), path)


def read_table(path: Path) -> tuple[dict[str, NDArray[np.float64]], dict[str, str]]:
    """Columns and notes that ``write_table`` wrote."""
    table = tables.read_table(path)
    about = {key.decode(): value.decode() for key, value in (table.schema.metadata or {}).items()}
    return {name: tables.column(table, name) for name in table.column_names}, about
