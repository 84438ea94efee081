"""Reads named columns of numbers from a file: MATLAB (v5 and v7.3), HDF5, CSV, JSON, Parquet, bags of ROS 2.

Everything numeric in a file is a column: a vector (n,), or a scalar as (1,). The samples of a matrix
lie along its longer axis. Names address the parts of a file: ``data_theta[2]`` (counted from zero) is
MATLAB's ``data_theta(:,3)``, ``run.position`` is a field of a structure, ``run/position`` a dataset in a
group of HDF5, and ``[0]``, ``[1]`` are the columns of a CSV file without a header. Two columns of one name
``a`` are ``a[0]`` and ``a[1]``. A row of units below the header of a CSV file joins it: ``angle [deg]``.
"""

from __future__ import annotations

import csv
import re
import warnings
from collections.abc import Callable, Iterator, Mapping, Sequence
from itertools import islice, zip_longest
from pathlib import Path
from typing import Any

import numpy as np

from hybridid.naming import shortened
from hybridid.records.bags import Instants, Stamped, read_bag
from hybridid.records.channel import Array, RecordError
from hybridid.records.columns import Columns
from hybridid.records.dates import seconds_of
from hybridid.records.json_columns import read_json, read_json_lines
from hybridid.records.units import is_unit


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


def _read_csv(path: Path) -> Found:
    import pandas as pd

    encoding = _encoding(path)
    with path.open(encoding=encoding, newline="") as file:
        sample = file.read(65536)
    lines = re.split(r"\r\n|\r|\n", sample)  # str.splitlines would end one at other characters, too
    preamble = _head(lines)
    first = lines[preamble] if lines else ""
    separator = " " if _separator(_usual(lines)) == " " else _separator(first)
    decimal = "," if separator != "," and re.search(r"\d,\d", sample) else "."
    cells = _cells(first, separator)
    has_header = any(not _is_number(cell, decimal) for cell in cells)
    units = _units(lines[preamble + 1 : preamble + 3], separator, decimal) if has_header else []

    def read() -> pd.DataFrame:
        return pd.read_csv(
            path,
            sep=r"\s+" if separator == " " else separator,
            decimal=decimal,
            header=0 if has_header else None,
            skiprows=[*range(preamble), preamble + 1] if units else preamble,
            skipinitialspace=True,
            encoding=encoding,
            index_col=False,
            low_memory=False,
        )

    with warnings.catch_warnings():
        warnings.simplefilter("error", pd.errors.ParserWarning)
        try:
            table = read()
        except pd.errors.ParserWarning:  # rows are longer than the header
            _check_cells(path, encoding, separator, preamble, len(cells))
            warnings.simplefilter("ignore", pd.errors.ParserWarning)
            table = read()
    names = _labels(cells, units) if has_header else [f"[{j}]" for j in range(len(table.columns))]
    for j, name in enumerate(names):
        series = table.iloc[:, j]
        if not series.isna().all():
            yield name, _numbers(series)
        elif has_header and name:  # a trailing separator makes one more, empty column
            yield name, "it is empty"


def _usual(lines: Sequence[str]) -> str:
    """A line of samples: the one in the middle, without comments."""
    filled = [line for line in lines if line.strip() and not line.startswith("#")]
    return filled[len(filled) // 2] if filled else ""


def _head(lines: Sequence[str]) -> int:
    """The line of a CSV file's header, after comments and after words of its logger: the first line with as
    many cells as the samples have, if those above it have fewer and it holds no number."""
    filled = [i for i, line in enumerate(lines) if line.strip() and not line.startswith("#")]
    if not filled:
        return 0
    separator = _separator(_usual(lines))
    decimal = "," if separator != "," else "."

    width = len(_cells(_usual(lines), separator))
    found = next(i for i in filled if len(_cells(lines[i], separator)) == width)
    words = not any(cell.strip() and _is_number(cell, decimal) for cell in _cells(lines[found], separator))
    return found if words else filled[0]


def _units(below: Sequence[str], separator: str, decimal: str) -> list[str]:
    """The cells of the line below a header if they are units: no number but 1 is among them, one is in the
    next line."""
    rows = [_cells(line, separator) for line in below]
    if len(rows) < 2 or not rows[0]:
        return []
    filled = [cell.strip() for cell in rows[0]]
    if any(cell not in ("", "1") and _is_number(cell, decimal) for cell in filled) or not any(filled):
        return []
    numbers = any(cell.strip() and _is_number(cell, decimal) for cell in rows[1])
    units = [cell.strip("[]() ") for cell in filled]
    return units if numbers and any(unit != "1" and is_unit(unit) for unit in units) else []


def _labels(cells: Sequence[str], units: Sequence[str]) -> list[str]:
    """The names of the columns: with the unit, where a row of units names it, and numbered, where one name
    stands over several columns."""
    names = [cell.strip() for cell in cells]
    names = [f"{n} [{u}]" if n and u else n for n, u in zip_longest(names, units[: len(names)], fillvalue="")]
    return [
        f"{name}[{names[:j].count(name)}]" if name and names.count(name) > 1 else name
        for j, name in enumerate(names)
    ]


def _check_cells(path: Path, encoding: str, separator: str, preamble: int, columns: int) -> None:
    """Separators at the end of a row may be too many, but no cell beyond the header may hold anything.

    Raises:
        RecordError: for the first row where one does.
    """
    with path.open(encoding=encoding, newline="") as file:
        rows = csv.reader(
            islice(file, preamble, None), delimiter=separator, skipinitialspace=separator == " "
        )
        for line, row in enumerate(rows, preamble + 1):
            if any(cell.strip() for cell in row[columns:]):
                raise RecordError(f"{path}: line {line} has {len(row)} cells under {columns} columns")


def _encoding(path: Path) -> str:
    """UTF-16 if the file says so, UTF-8 if it is valid UTF-8, else Latin-1: older loggers write ° and µ."""
    content = path.read_bytes()
    if content.startswith((b"\xff\xfe", b"\xfe\xff")):
        return "utf-16"
    try:
        content.decode("utf-8-sig")
    except UnicodeDecodeError:
        return "latin-1"
    return "utf-8-sig"


def _separator(line: str) -> str:
    """The character between the cells of ``line``: a tab or semicolon if there is one, else a comma; a space
    if there is none of these and it holds several numbers."""
    outside_quotes = re.sub(r'"[^"]*"', "", line)
    spaced = len(line.split()) > 1 and all(_is_number(word, ".") for word in line.split())
    return next((s for s in ("\t", ";", ",", "|") if s in outside_quotes), " " if spaced else ",")


def _cells(line: str, separator: str) -> list[str]:
    """The cells of one line; several spaces are one separator."""
    return line.split() if separator == " " else next(csv.reader([line], delimiter=separator), [])


def _is_number(cell: str, decimal: str) -> bool:
    try:
        float(cell.strip().replace(decimal, ".") or "nan")
    except ValueError:
        return False
    return True


def _numbers(series: Any) -> Array | Instants | str:
    """A pandas column as floats, missing values as NaN; or why not."""
    import pandas as pd
    from pandas.api import types

    if len(series) and series.isna().all() and not types.is_numeric_dtype(series):
        return "it is empty"
    if types.is_datetime64_any_dtype(series):
        return Instants((series - series.dropna().iloc[0]).dt.total_seconds().to_numpy(float))
    if types.is_timedelta64_dtype(series):
        return Instants(series.dt.total_seconds().to_numpy(float))
    if types.is_numeric_dtype(series) and not types.is_complex_dtype(series):
        return series.to_numpy(float, na_value=np.nan)
    try:
        numeric = pd.to_numeric(series, errors="coerce")
    except TypeError:  # lists, mappings
        return f"it holds {shortened(repr(series.dropna().iloc[0]), 60)}, no number"
    wrong = series[numeric.isna() & series.notna()]
    if len(wrong) == 0:
        return numeric.to_numpy(float, na_value=np.nan)
    stamps = seconds_of([one if isinstance(one, str) else None for one in series])
    if stamps is not None:
        return Instants(stamps)
    row = int(np.flatnonzero(series.index == wrong.index[0])[0])
    return f"it holds {shortened(repr(wrong.iloc[0]), 60)} at sample {row}, no number"


def _read_parquet(path: Path) -> Found:
    import pandas as pd

    table = pd.read_parquet(path)
    index = table.index
    if index.name is not None:  # pandas writes a named index, often the time, beside the columns
        table = table.reset_index()
    for label in table.columns:
        yield str(label), _numbers(table[label])


READERS: Mapping[str, Callable[[Path], Found]] = {
    ".mat": _read_mat,
    ".csv": _read_csv,
    ".tsv": _read_csv,
    ".txt": _read_csv,
    ".dat": _read_csv,
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
