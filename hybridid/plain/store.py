"""From frozen dataclasses to what JSON holds.

What a field says in its ``metadata`` changes how it is stored:

``{"stored": False}``
    is left out; ``restored`` gives it its default.
``{"key": "class"}``
    has this key instead of its own name.
``{"null": value}``
    null is read back as ``value``; without it a null number is read back as nan.
``{"by": "name"}``
    of a tuple of dataclasses: a mapping from their field ``name`` to their other fields.
``{"inline": True}``
    of a dataclass: its fields stand beside the other fields, not below a key of their own.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Mapping
from pathlib import PurePath
from typing import Any

import numpy as np


def plain(value: Any) -> Any:
    """``value`` as dicts, lists, numbers, text, booleans and None, to be written as strict JSON.

    Dataclasses become dicts by field name, mappings dicts by text, tuples and numpy arrays (of any
    shape) lists, paths text. A number that is not finite becomes None.

    Raises:
        TypeError: for a value of any other kind.
    """
    if value is None or isinstance(value, bool | int | str):
        return value
    if isinstance(value, float):
        return float(value) if math.isfinite(value) else None
    if isinstance(value, np.generic):
        return plain(value.item())
    if isinstance(value, np.ndarray):
        return plain(value.tolist())
    if isinstance(value, Mapping):
        return {str(key): plain(below) for key, below in value.items()}
    if isinstance(value, list | tuple):
        return [plain(item) for item in value]
    if isinstance(value, PurePath):
        return str(value)
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        return _fields(value)
    raise TypeError(f"a {type(value).__name__} cannot be written as plain data: {value!r}")


def key_of(f: dataclasses.Field[Any]) -> str:
    """The key of a field in a file."""
    return str(f.metadata.get("key", f.name))


def _fields(value: Any) -> dict[str, Any]:
    """The stored fields of a dataclass."""
    found: dict[str, Any] = {}
    for f in dataclasses.fields(value):
        below = getattr(value, f.name)
        if not f.metadata.get("stored", True):
            continue
        if f.metadata.get("inline"):
            found |= plain(below)
        elif "by" in f.metadata:
            found[key_of(f)] = _by(below, f.metadata["by"])
        else:
            found[key_of(f)] = plain(below)
    return found


def _by(values: tuple[Any, ...], name: str) -> dict[str, Any]:
    """Dataclasses by one of their fields."""
    rows = [plain(value) for value in values]
    return {row.pop(name): row for row in rows}
