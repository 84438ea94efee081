"""Reads named columns of numbers from a file: MATLAB (v5 and v7.3), HDF5, CSV, JSON, Parquet, bags of ROS 2.

Everything numeric in a file is a column: a vector (n,), or a scalar as (1,). The samples of a matrix
lie along its longer axis. Names address the parts of a file: ``data_theta[2]`` (counted from zero) is
MATLAB's ``data_theta(:,3)``, ``run.position`` is a field of a structure, ``run/position`` a dataset in a
group of HDF5, and ``[0]``, ``[1]`` are the columns of a CSV file without a header. Two columns of one name
``a`` are ``a[0]`` and ``a[1]``. A row of units below the header of a CSV file joins it: ``angle [deg]``.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from hybridid.naming import shortened
from hybridid.records.bags import Instants, Stamped, read_bag
from hybridid.records.channel import Array, RecordError
from hybridid.records.columns import Columns
from hybridid.records.csv_columns import numbers, read_csv
from hybridid.records.json_columns import read_json, read_json_lines


def read_columns(path: Path | str) -> Columns:
    """Every column of the file at ``path``, read by its suffix.

    Raises:
        RecordError: if the suffix is none of ``READERS``, or the file is missing, broken or empty.
    """
    path = Path(path)
    reader = READERS.get(path.suffix.lower())
    if reader is None and path.suffix.lower() in CONVERTED:
        raise RecordError(f"{path}: {path.suffix} is not read: {CONVERTED[path.suffix.lower()]}")
    if reader is None:
        raise RecordError(f"{path}: {path.suffix or 'no suffix'} is not read; allowed: {', '.join(READERS)}")
    if not path.is_file():
        raise RecordError(f"{path}: no such file")
    if path.stat().st_size == 0:
        raise RecordError(f"{path}: the file is empty")
    try:
        found = list(reader(path))
    except RecordError:
        raise
    except Exception as wrong:  # each library raises errors of its own for a broken file
        reason = shortened(str(wrong), 200) or type(wrong).__name__
        raise RecordError(f"{path}: not a readable {path.suffix} file: {reason}") from wrong
    instants = {name: content.seconds for name, content in found if isinstance(content, Instants)}
    stamped = {name: content for name, content in found if isinstance(content, Stamped)}
    columns = Columns(
        path,
        {name: content for name, content in found if isinstance(content, np.ndarray)}
        | instants
        | {name: content.values for name, content in stamped.items()},
        {name: content for name, content in found if isinstance(content, str)},
        frozenset(instants),
        {name: content.clock for name, content in stamped.items()},
    )
    if not columns:
        why = next((f"; {name}: {reason}" for name, reason in columns.unusable.items()), "")
        raise RecordError(f"{path}: it holds no column of numbers{why}")
    return columns


Found = Iterator[tuple[str, "Array | Instants | Stamped | str"]]  # a column's values, or why it has none


def _read_mat(path: Path) -> Found:
    from pymatreader import read_mat

    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # about classes and strings, which are no signals
        variables = read_mat(path)
    for name in sorted(variables):
        if not name.startswith(("__", "#")):
            yield from _flattened(name, variables[name])


def _flattened(name: str, content: Any) -> Found:
    """The columns in one MATLAB variable: one for each field, cell, and column of a matrix."""
    if isinstance(content, Mapping):
        for key, value in content.items():
            yield from _flattened(f"{name}.{key}", value)
    elif isinstance(content, list):
        for i, value in enumerate(content):
            yield from _flattened(f"{name}[{i}]", value)
    else:
        yield from _cut(name, np.asarray(content))


def _cut(name: str, array: np.ndarray) -> Found:
    array = np.squeeze(array)
    if array.dtype.kind not in "biuf":
        yield name, f"it holds {_KINDS.get(array.dtype.kind, 'no numbers')}"
    elif array.size == 0:
        yield name, "it is empty"
    elif array.ndim <= 1:
        yield name, np.atleast_1d(array).astype(float)
    elif array.ndim == 2:
        signals = array.T if array.shape[0] >= array.shape[1] else array
        yield from ((f"{name}[{j}]", signal.astype(float)) for j, signal in enumerate(signals))
    else:
        yield name, f"it has {array.ndim} dimensions, at most 2 are read"


def _read_hdf5(path: Path) -> Found:
    import h5py

    with h5py.File(path, "r") as file:
        found: list[tuple[str, Any]] = []
        file.visititems(lambda name, item: found.append((name, item[()])) if hasattr(item, "dtype") else None)
    for name, content in found:
        fields = getattr(getattr(content, "dtype", None), "names", None)
        if fields:  # a table: an array of samples with named fields
            for field in fields:
                yield from _cut(f"{name}/{field}", np.asarray(content[field]))
        else:
            yield from _cut(name, np.asarray(content))


_KINDS = {"c": "complex numbers", "U": "text", "S": "text", "O": "objects", "M": "dates", "m": "durations"}


def _read_parquet(path: Path) -> Found:
    import pandas as pd

    table = pd.read_parquet(path)
    index = table.index
    if index.name is not None:  # pandas writes a named index, often the time, beside the columns
        table = table.reset_index()
    for label in table.columns:
        yield str(label), numbers(table[label])


READERS: Mapping[str, Callable[[Path], Found]] = {
    ".mat": _read_mat,
    ".csv": read_csv,
    ".tsv": read_csv,
    ".txt": read_csv,
    ".dat": read_csv,
    ".json": read_json,
    ".jsonl": read_json_lines,
    ".ndjson": read_json_lines,
    ".h5": _read_hdf5,
    ".hdf5": _read_hdf5,
    ".parquet": _read_parquet,
    ".mcap": read_bag,
    ".db3": read_bag,
}
CONVERTED: Mapping[str, str] = {
    ".bag": "write it as an MCAP file of ROS 2, with rosbags-convert",
    ".xlsx": "save its sheet as CSV",
    ".xls": "save its sheet as CSV",
    ".ods": "save its sheet as CSV",
    ".tdms": "write it as CSV or HDF5, with npTDMS",
    ".mf4": "write it as Parquet or MATLAB, with asammdf",
    ".mdf": "write it as Parquet or MATLAB, with asammdf",
    ".npy": "write it as CSV, with numpy.savetxt",
    ".npz": "write it as MATLAB, with scipy.io.savemat",
}
"""How a recording of another format becomes one that is read."""
