"""The columns of a text file: numbers between commas, semicolons, tabs, bars or spaces.

Decimal points or commas, UTF-8, UTF-16 or Latin-1. Comments and words of the logger may stand above the
header, a row of units below it, or there is no header.
"""

from __future__ import annotations

import csv
import re
import warnings
from collections.abc import Iterator, Sequence
from itertools import islice, zip_longest
from pathlib import Path
from typing import Any

import numpy as np

from hybridid.naming import shortened
from hybridid.records.bags import Instants
from hybridid.records.channel import Array, RecordError
from hybridid.records.dates import seconds_of
from hybridid.records.units import is_unit

GAPS = ("nan", "null", "none", "n/a", "na")
"""Words of loggers for a value that is not there, in small letters."""


def read_csv(path: Path) -> Iterator[tuple[str, Array | Instants | str]]:
    """The columns of the text file at ``path``, or why one is none.

    Raises:
        RecordError: if a row has cells beyond its header.
    """
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
            yield name, numbers(series)
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


def numbers(series: Any) -> Array | Instants | str:
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
    wrong = wrong[~wrong.astype(str).str.strip().str.lower().isin(GAPS)]
    if len(wrong) == 0:
        return numeric.to_numpy(float, na_value=np.nan)
    stamps = seconds_of([one if isinstance(one, str) else None for one in series])
    if stamps is not None:
        return Instants(stamps)
    words = sorted({one for one in wrong if isinstance(one, str)})
    if len(wrong) == len(series) and len(words) == 2:
        said = " and ".join(shortened(repr(word), 30) for word in words)
        return f"it holds the words {said}, no numbers: write 0 and 1 in their place"
    row = int(np.flatnonzero(series.index == wrong.index[0])[0])
    return f"it holds {shortened(repr(wrong.iloc[0]), 60)} at sample {row} (the first is 0), no number"
