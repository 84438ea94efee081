"""Columns of numbers in a Parquet file, read without pandas and pyarrow's dataset engine.

``pyarrow.parquet.read_table`` and ``to_numpy`` load both, which costs every command and worker half a second.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

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


def column(table: pa.Table, name: str) -> NDArray[np.float64]:
    """One column of numbers, (n,), read-only."""
    return np.asarray(np.from_dlpack(table[name].combine_chunks()), dtype=np.float64)
