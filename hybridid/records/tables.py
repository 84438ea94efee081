"""Columns of numbers in a Parquet file, read and written without pandas and pyarrow's dataset engine.

``pyarrow.parquet.read_table``, ``pyarrow.table`` of arrays and ``to_numpy`` load them. This costs every
command and worker half a second.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    import pyarrow as pa


def read_table(path: Path) -> pa.Table:
    """All columns of the Parquet file at ``path``.

    Raises:
        ArrowException: if it is not a Parquet file.
    """
    from pyarrow import parquet

    with parquet.ParquetFile(path) as file:
        return file.read()


def table_of(columns: Mapping[str, NDArray[Any]]) -> pa.Table:
    """Columns of numbers or words, (n,) each, as a table."""
    import pyarrow as pa

    return pa.table({name: _arrow(np.asarray(values)) for name, values in columns.items()})


def _arrow(values: NDArray[Any]) -> pa.Array:
    """``values``, whose memory is shared if they are numbers in one piece."""
    import pyarrow as pa

    if values.dtype.kind not in "fiu":
        return pa.array(values.tolist())
    whole = np.ascontiguousarray(values)
    return pa.Array.from_buffers(pa.from_numpy_dtype(whole.dtype), len(whole), [None, pa.py_buffer(whole)])


def column(table: pa.Table, name: str) -> NDArray[np.float64]:
    """One column of numbers, (n,), read-only."""
    return np.asarray(np.from_dlpack(table[name].combine_chunks()), dtype=np.float64)
