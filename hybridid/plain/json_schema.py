"""What a file of results looks like, for whoever reads it with other tools: JSON Schema, draft 2020-12."""

from __future__ import annotations

import dataclasses
import inspect
import types
import typing
from collections.abc import Mapping
from pathlib import PurePath
from typing import Any, Literal, Union

import numpy as np

from hybridid.plain.store import key_of
from hybridid.settings.declare import of_field

Schema = dict[str, Any]
Below = dict[type, Schema]
"""The schemas of the dataclasses that one holds."""


def schema(cls: Any) -> Schema:
    """The schema of the file that ``plain(value)`` makes of a ``cls``: a dataclass, or a tuple of some.

    Descriptions are the docstrings of the dataclasses; a field adds its own by ``metadata``:
    ``{"meaning": "...", "unit": "..."}``, or as a ``setting``. Every key that is written is required,
    and no other is allowed.

    Raises:
        TypeError: for an annotation that ``plain`` writes nothing of, or two dataclasses of one name.
    """
    below: Below = {}
    found = _of(cls, below)
    if "$ref" in found:
        found = below.pop(cls)
    about: Schema = {"$schema": "https://json-schema.org/draft/2020-12/schema"}
    return {**about, **found, **({"$defs": _by_name(below)} if below else {})}


def _by_name(below: Below) -> dict[str, Schema]:
    named = {one.__name__: own for one, own in sorted(below.items(), key=lambda item: item[0].__name__)}
    if len(named) < len(below):
        raise TypeError(f"two of these have one name: {', '.join(sorted(map(str, below)))}")
    return named


def _of(hint: Any, below: Below) -> Schema:
    """The schema of one annotation; those of dataclasses go to ``below``."""
    origin, arguments = typing.get_origin(hint), typing.get_args(hint)
    if hint in _SCALARS:
        return dict(_SCALARS[hint])
    if origin in (Union, types.UnionType):
        return _union([_of(one, below) for one in arguments])
    if origin is Literal:
        return {"enum": list(arguments)}
    if origin is tuple:
        return _tuple(arguments, below)
    if origin is np.ndarray:
        return {"type": "array", "description": "numbers, or lists of them by row"}
    if isinstance(origin, type) and issubclass(origin, Mapping):
        return {"type": "object", "additionalProperties": _of(arguments[1], below)}
    if isinstance(hint, type) and issubclass(hint, PurePath):
        return {"type": "string"}
    if isinstance(hint, type) and dataclasses.is_dataclass(hint):
        if hint not in below:
            below[hint] = {}  # a dataclass may hold more of itself
            below[hint] = _object(hint, below)
        return {"$ref": f"#/$defs/{hint.__name__}"}
    raise TypeError(f"no schema for {hint!r}")


def _union(options: list[Schema]) -> Schema:
    """Types of scalars in one list, everything else one of several."""
    if all(set(one) == {"type"} for one in options):
        names = [name for one in options for name in _listed(one["type"])]
        return {"type": list(dict.fromkeys(names))}
    return {"anyOf": options}


def _listed(names: str | list[str]) -> list[str]:
    return [names] if isinstance(names, str) else names


def _tuple(items: tuple[Any, ...], below: Below) -> Schema:
    if items[-1] is Ellipsis:
        return {"type": "array", "items": _of(items[0], below)}
    each = [_of(item, below) for item in items]
    return {"type": "array", "prefixItems": each, "minItems": len(each), "maxItems": len(each)}


def _object(cls: Any, below: Below) -> Schema:
    """A dataclass; of one that holds one of several inline, each of its forms."""
    hints = typing.get_type_hints(cls)
    for f in dataclasses.fields(cls):
        if f.metadata.get("inline") and typing.get_origin(hints[f.name]) in (Union, types.UnionType):
            options = typing.get_args(hints[f.name])
            return {"anyOf": [_form(cls, {**hints, f.name: option}, below) for option in options]}
    return _form(cls, hints, below)


def _form(cls: Any, hints: Mapping[str, Any], below: Below) -> Schema:
    properties: dict[str, Schema] = {}
    descriptions = [_described(cls)]
    for f in dataclasses.fields(cls):
        if not f.metadata.get("stored", True):
            continue
        if f.metadata.get("inline"):
            properties |= _object(hints[f.name], below)["properties"]
            descriptions.append(_described(hints[f.name]))
        elif "by" in f.metadata:
            properties[key_of(f)] = _by(typing.get_args(hints[f.name])[0], f.metadata["by"], below)
        else:
            properties[key_of(f)] = _of(hints[f.name], below) | _field_description(f)
    return {
        "title": cls.__name__,
        "description": "\n\n".join(filter(None, descriptions)),
        "type": "object",
        "properties": properties,
        "required": list(properties),
        "additionalProperties": False,
    }


def _described(cls: Any) -> str:
    """The docstring, without what only a caller must know."""
    text = inspect.getdoc(cls) or ""
    return "" if text.startswith(f"{cls.__name__}(") else text.partition("\n\nRaises:")[0]


def _by(cls: Any, name: str, below: Below) -> Schema:
    """A mapping from the field ``name`` of ``cls`` to the others."""
    one = _object(cls, below)
    others = {key: value for key, value in one["properties"].items() if key != name}
    return {
        "type": "object",
        "description": f"by {name}",
        "additionalProperties": {**one, "properties": others, "required": list(others)},
    }


def _field_description(field: dataclasses.Field[Any]) -> Schema:
    known = of_field(field)
    meaning, unit = (known.meaning, known.unit) if known else _meaning_and_unit(field.metadata)
    return {"description": f"{meaning}, in {unit}" if unit else meaning} if meaning else {}


def _meaning_and_unit(metadata: Mapping[str, Any]) -> tuple[str, str]:
    return str(metadata.get("meaning", "")), str(metadata.get("unit", ""))


_SCALARS: Mapping[Any, Schema] = {
    Any: {},
    object: {},
    # what is not finite is written as null
    float: {"type": ["number", "null"]},
    int: {"type": "integer"},
    bool: {"type": "boolean"},
    str: {"type": "string"},
    type(None): {"type": "null"},
}
