"""The columns of a JSON recording: a list of samples, with constants of the recording beside it.

Three shapes are read. ``entries`` may have any name:

    {"kp": 100, "entries": [{"t": 0.0, "q": 0.1}, {"t": 0.1, "q": 0.2}]}    constants and samples
    [{"t": 0.0, "q": 0.1}, {"t": 0.1, "q": 0.2}]                            samples
    {"kp": 100, "t": [0.0, 0.1], "q": [0.1, 0.2]}                           constants and columns

JSON lines hold the same samples, an object in each line. Objects may hold objects, and samples short lists:
``{"motor": {"current": 1.5}, "gyro": [0.1, 0.2]}`` gives ``motor.current``, ``gyro[0]`` and ``gyro[1]``.

A constant becomes a column that repeats it, so that it can be a signal: a gain that differs from one
recording to the next is an input of the model. ``true`` is 1, ``false`` is 0, ``null`` is a missing value.
Dates that are text serve as time.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from hybridid.records.bags import Instants
from hybridid.records.channel import Array, RecordError
from hybridid.records.dates import seconds_of

DEEPEST, LONGEST = 8, 64
"""So many objects in objects, and entries of a list in a sample, become columns."""
SHAPES = (
    "a list of samples, each an object of numbers, or an object that holds numbers beside one such list or "
    "beside lists of numbers"
)


def read_json(path: Path) -> Iterator[tuple[str, Array | Instants | str]]:
    """The columns of the JSON file at ``path``, each (n,), or why a column is none.

    Raises:
        RecordError: if the content has none of the three shapes.
        ValueError: if it is no JSON.
    """
    content = json.loads(path.read_text(encoding="utf-8-sig"))
    if isinstance(content, list):
        content = {"": content}
    if not isinstance(content, Mapping):
        raise RecordError(f"{path}: it holds {_kind(content)}; {SHAPES} is read")
    content = _named(content, 0, str(path))
    lists = {name: value for name, value in content.items() if isinstance(value, list)}
    tables = [
        name for name, value in lists.items() if value and all(isinstance(one, Mapping) for one in value)
    ]
    if len(tables) > 1:
        raise RecordError(
            f"{path}: it holds {len(tables)} lists of samples, {', '.join(tables)}; {SHAPES} is read"
        )
    if not lists or (not tables and "" in lists):
        raise RecordError(f"{path}: it holds no list of samples; {SHAPES} is read")
    columns = _of_samples(lists.pop(tables[0]), str(path)) if tables else {}
    columns |= {name: _numbers(value) for name, value in lists.items()}
    return _with_constants(
        columns, {name: value for name, value in content.items() if not isinstance(value, list)}
    )


def read_json_lines(path: Path) -> Iterator[tuple[str, Array | Instants | str]]:
    """The columns of a file with a sample in each line.

    Raises:
        RecordError: if a line is no JSON object; a logger that was cut off leaves half a line at the end.
    """
    samples = []
    for number, line in enumerate(path.read_text(encoding="utf-8-sig").splitlines(), 1):
        if line.strip():
            samples.append(_sample(line, f"{path}: line {number}"))
    yield from _of_samples(samples, str(path)).items()


def _sample(line: str, where: str) -> Mapping[str, Any]:
    try:
        found = json.loads(line)
    except ValueError as wrong:
        raise RecordError(f"{where} is no JSON: {line[:40]!r}") from wrong
    if not isinstance(found, Mapping):
        raise RecordError(f"{where} holds {_kind(found)}, expected an object of numbers")
    return found


def _of_samples(samples: Sequence[Mapping[str, Any]], where: str) -> dict[str, Array | Instants | str]:
    """The columns of a list of samples, in the order in which their names appear."""
    flat = [_named(sample, LONGEST, f"{where}: sample {k}") for k, sample in enumerate(samples)]
    names = dict.fromkeys(name for sample in flat for name in sample)
    return {name: _across(name, flat) for name in names}


def _named(content: Mapping[str, Any], longest: int, where: str) -> dict[str, Any]:
    """``_flat``, where each name must be that of one value.

    Raises:
        RecordError: if an object in it makes a name that a key of its own has.
    """
    if not any(isinstance(value, (dict, list)) for value in content.values()):
        return dict(content)  # most often, and long files have many samples
    found: dict[str, Any] = {}
    for name, value in _flat(content, longest):
        if name in found:
            raise RecordError(f"{where}: {name!r} names two values, one in an object: rename a key")
        found[name] = value
    return found


def _flat(content: Mapping[str, Any], longest: int, depth: int = 1) -> Iterator[tuple[str, Any]]:
    """Each value of an object by its name; those of an object in it as ``name.key``, and of a list of up to
    ``longest`` entries as ``name[0]``."""
    for name, value in content.items():
        inner: Mapping[str, Any] = {}
        if isinstance(value, dict) and depth < DEEPEST:
            inner = {f"{name}.{key}": one for key, one in value.items()}
        elif isinstance(value, list) and len(value) <= longest:
            inner = {f"{name}[{k}]": one for k, one in enumerate(value)}
        yield from _flat(inner, longest, depth + 1) if inner else ((name, value),)


def _across(name: str, samples: Sequence[Mapping[str, Any]]) -> Array | Instants | str:
    for k, sample in enumerate(samples):
        if name not in sample:
            return f"sample {k} does not have it"
    return _numbers([sample[name] for sample in samples])


def _numbers(values: Sequence[Any]) -> Array | Instants | str:
    """A list as floats, or as stamps that are text, or why it is none."""
    if values and isinstance(values[0], str) and all(one is None or isinstance(one, str) for one in values):
        stamps = seconds_of(values)
        if stamps is not None:
            return Instants(stamps)
    for k, value in enumerate(values):
        if value is not None and not isinstance(value, (bool, int, float)):
            return f"it holds {_kind(value)} at sample {k}, no number"
    return (
        np.array([np.nan if value is None else float(value) for value in values]) if values else "it is empty"
    )


def _with_constants(
    columns: Mapping[str, Array | Instants | str], constants: Mapping[str, Any]
) -> Iterator[tuple[str, Array | Instants | str]]:
    """The columns, then the constants, as long as the longest column."""
    n = max((_length(column) for column in columns.values() if not isinstance(column, str)), default=1)
    for name, column in columns.items():
        yield name, "it is both a constant and a column" if name in constants else column
    for name, value in constants.items():
        if name not in columns:
            one = _numbers([value])
            yield (
                name,
                np.repeat(one, n) if isinstance(one, np.ndarray) else f"it holds {_kind(value)}, no number",
            )


def _length(column: Array | Instants) -> int:
    return len(column.seconds if isinstance(column, Instants) else column)


def _kind(value: Any) -> str:
    if isinstance(value, str):
        return f"the text {value[:40]!r}"
    return {dict: "an object", list: "a list", type(None): "null"}.get(
        type(value), f"the value {value!r}"[:40]
    )
