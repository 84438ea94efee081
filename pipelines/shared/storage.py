"""Numbers in files that any program can read: strict JSON, and Parquet for series."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hybridid.records import tables


def write_json(path: Path, data: Any) -> None:
    """Strict JSON: what is not finite becomes null."""
    path.write_text(json_text(data), encoding="utf-8")


def json_text(data: Any) -> str:
    """What ``write_json`` writes."""
    return json.dumps(_strict(data), indent=1, ensure_ascii=False, allow_nan=False) + "\n"


def read_json(path: Path) -> Any:
    """What ``write_json`` wrote."""
    return json.loads(path.read_text(encoding="utf-8"))


def write_table(path: Path, columns: Mapping[str, NDArray[Any]], about: Mapping[str, str]) -> None:
    """Columns of equal length as Parquet, with notes on the whole in its metadata."""
    import pyarrow
    from pyarrow import parquet

    table = pyarrow.table({name: np.asarray(values) for name, values in columns.items()})
    parquet.write_table(table.replace_schema_metadata(dict(about)), path)


def read_table(path: Path) -> tuple[dict[str, NDArray[np.float64]], dict[str, str]]:
    """Columns and notes that ``write_table`` wrote."""
    table = tables.read_table(path)
    about = {key.decode(): value.decode() for key, value in (table.schema.metadata or {}).items()}
    return {name: tables.column(table, name) for name in table.column_names}, about


def _strict(value: Any) -> Any:
    if isinstance(value, Mapping):
        return {str(key): _strict(below) for key, below in value.items()}
    if isinstance(value, (list, tuple)):
        return [_strict(item) for item in value]
    if isinstance(value, np.generic):
        return _strict(value.item())
    if isinstance(value, np.ndarray):
        return _strict(value.tolist())
    return None if isinstance(value, float) and not math.isfinite(value) else value
