"""From plain data, as a config or a JSON file holds them, to frozen dataclasses.

``build`` is for what a user wrote: whatever is not understood is a mistake, and costs one line: where
it is, what is allowed, and the nearest right name. ``restored`` is for what ``plain`` wrote.
"""

from __future__ import annotations

import dataclasses
import types
import typing
from collections.abc import Mapping, Sequence
from pathlib import PurePath
from typing import Any, Literal, TypeVar, Union

import numpy as np

from hybridid.naming import nearest, shortened, unknown
from hybridid.plain.section import is_section, section
from hybridid.plain.store import key_of
from hybridid.settings.bounds import kind
from hybridid.settings.declare import hints_of

T = TypeVar("T")
LARGEST = 2**63 - 1
"""Whole numbers beyond this one fit neither an array nor, from some 300 digits on, a float."""


@dataclasses.dataclass(frozen=True)
class _Rules:
    """``error`` is raised. ``stored``: keys may be unknown, null stands for what is not finite, and fields
    have the forms that ``hybridid.plain.store`` names; else a lone value stands for a tuple of one."""

    error: type[ValueError]
    stored: bool


def build(cls: type[T], values: Mapping[str, Any], where: str, error: type[ValueError]) -> T:
    """A dataclass ``cls`` from a plain mapping, converted by its field types.

    Understood are numbers, text, booleans, ``Literal``, optional values, tuples (a lone value
    stands for a tuple of one), mappings and dataclasses; 1e3 is a whole number. A tuple of dataclasses
    may also be written as a mapping from their ``name`` to the rest, which is easier to override from a
    command line. Where the fields of ``cls`` are declared as settings, only those are keys, their bounds
    are checked, and a message names a key by its dotted name below ``where``.

    Raises:
        error: for an unknown or missing key or a value of the wrong kind, in one line that
            starts with ``where``; so for a ``ValueError`` that ``cls`` itself raises.
    """
    return typing.cast(T, _dataclass(values, cls, where, _Rules(error, stored=False)))


def restored(cls: type[T], data: Any, where: str, error: type[ValueError] = ValueError) -> T:
    """What ``plain`` made plain: ``cls`` is a dataclass, or a tuple or mapping of some.

    Null becomes nan where a number stood, or what the field's metadata name. Lists become numpy arrays
    where the annotation says ``NDArray``. Keys that ``cls`` lacks are ignored: a newer version may
    have written more. Fields that were not stored, or are missing, get their defaults.

    Raises:
        error: if a key without a default is missing or a value is of another kind, in one line that
            starts with ``where``, such as the file's path.
    """
    return typing.cast(T, _convert(data, cls, where, _Rules(error, stored=True)))


def _dataclass(values: Any, cls: Any, where: str, rules: _Rules) -> Any:
    if not rules.stored and is_section(cls):
        return section(cls, values, where, rules.error, lambda v, hint, at: _convert(v, hint, at, rules))
    if not isinstance(values, Mapping):
        raise rules.error(f"{where}: expected a mapping of keys to values, got {values!r}")
    fields = {f.name: f for f in dataclasses.fields(cls) if f.init}
    hints = hints_of(cls)
    if rules.stored:
        values = {name: _as_stored(values, f) for name, f in fields.items() if _is_there(values, f)}
    for key in values:
        if key not in fields:
            raise rules.error(f"{where}: {unknown('key', key, fields)}")
    for name, f in fields.items():
        required = f.default is dataclasses.MISSING and f.default_factory is dataclasses.MISSING
        if required and (name not in values or (values[name] is None and not rules.stored)):
            keys = ", ".join(map(key_of, fields.values()))
            raise rules.error(f"{where}: key {key_of(f)!r} is missing; keys: {keys}")
    converted = {
        name: fields[name].metadata["null"]
        if value is None and "null" in fields[name].metadata
        else _convert(value, hints[name], f"{where}: {name}", rules)
        for name, value in values.items()
    }
    try:
        return cls(**converted)
    except ValueError as wrong:
        raise rules.error(f"{where}: {wrong}") from wrong


def _is_there(values: Mapping[str, Any], f: dataclasses.Field[Any]) -> bool:
    return f.metadata.get("stored", True) and (key_of(f) in values or "inline" in f.metadata)


def _as_stored(values: Mapping[str, Any], f: dataclasses.Field[Any]) -> Any:
    """A field's value, out of the forms in which ``plain`` stores some."""
    if f.metadata.get("inline"):
        return values
    value = values[key_of(f)]
    if "by" in f.metadata and isinstance(value, Mapping):
        return [{f.metadata["by"]: key, **below} for key, below in value.items()]
    return value


def _convert(value: Any, hint: Any, where: str, rules: _Rules) -> Any:
    """``value`` as the annotation ``hint`` asks."""
    origin, arguments = typing.get_origin(hint), typing.get_args(hint)
    if origin in (Union, types.UnionType):
        return _union(value, arguments, where, rules)
    if origin is Literal:
        if value not in arguments:
            allowed = [str(word) for word in arguments]
            near = nearest(value, allowed)
            raise rules.error(f"{where} is {value!r}: {near}allowed: {', '.join(allowed)}")
        return value
    if origin is tuple:
        return _tuple(value, arguments, where, rules)
    if dataclasses.is_dataclass(hint) and isinstance(hint, type):
        return value if isinstance(value, hint) else _dataclass(value, hint, where, rules)
    if isinstance(origin, type) and issubclass(origin, Mapping):
        return _mapping(value, arguments, where, rules)
    if rules.stored:
        return _stored(value, hint, where, rules)
    return _scalar(value, hint, where, rules)


def _mapping(value: Any, arguments: tuple[Any, ...], where: str, rules: _Rules) -> dict[Any, Any]:
    if not isinstance(value, Mapping):
        raise rules.error(f"{where}: expected a mapping of keys to values, got {value!r}")
    key = int if arguments[0] is int else str
    return {key(k): _convert(v, arguments[1], f"{where}: {k}", rules) for k, v in value.items()}


def _stored(value: Any, hint: Any, where: str, rules: _Rules) -> Any:
    """What a config never holds: null for a number, arrays, paths."""
    origin, arguments = typing.get_origin(hint), typing.get_args(hint)
    if hint is float and value is None:
        return float("nan")
    if origin is np.ndarray:
        return _array(value, typing.get_args(arguments[1])[0], where, rules)
    if isinstance(hint, type) and issubclass(hint, PurePath):
        return hint(_scalar(value, str, where, rules))
    return _scalar(value, hint, where, rules)


def _array(value: Any, number: Any, where: str, rules: _Rules) -> Any:
    """An array of numbers; null in it becomes nan."""
    try:
        return np.array(value, dtype=None if number is Any else number)
    except (TypeError, ValueError):
        raise rules.error(f"{where}: expected an array of numbers") from None


def _scalar(value: Any, hint: Any, where: str, rules: _Rules) -> Any:
    if hint in _SCALARS and not _SCALARS[hint](value):
        raise rules.error(f"{where} is {value!r}: expected {kind(hint)}")
    if isinstance(value, int) and hint in (float, int) and abs(value) > LARGEST:
        raise rules.error(f"{where} is {shortened(repr(value), 60)}: whole numbers end at 2^63 - 1")
    return hint(value) if hint in (float, int) else value


def _union(value: Any, options: tuple[Any, ...], where: str, rules: _Rules) -> Any:
    """The first of ``options`` that fits; if none does, what all of them expect, or the first's complaint."""
    if value is None and type(None) in options:
        return None
    complaints: list[ValueError] = []
    for option in options:
        if option is not type(None):
            try:
                return _convert(value, option, where, rules)
            except rules.error as wrong:
                complaints.append(wrong)
    simple = not any(dataclasses.is_dataclass(option) for option in options)
    if len(complaints) > 1 and simple:
        raise rules.error(f"{where} is {value!r}: expected {' or '.join(map(kind, options))}")
    raise complaints[0]


def _tuple(value: Any, items: tuple[Any, ...], where: str, rules: _Rules) -> tuple[Any, ...]:
    if rules.stored and not isinstance(value, Sequence):
        raise rules.error(f"{where}: expected a list, got {value!r}")
    if isinstance(value, Mapping) and dataclasses.is_dataclass(items[0]):
        if not set(value) & {f.name for f in dataclasses.fields(items[0])}:
            return _by_name(value, items[0], where, rules)
        value = [value]
    if isinstance(value, str) or not isinstance(value, Sequence):
        value = [value]
    if items[-1] is Ellipsis:
        items = (items[0],) * len(value)
    if len(value) != len(items):
        raise rules.error(f"{where} has {len(value)} values, expected {len(items)}")
    pairs = enumerate(zip(value, items, strict=True))
    return tuple(_convert(v, item, f"{where}[{i}]", rules) for i, (v, item) in pairs)


def _by_name(value: Mapping[str, Any], cls: Any, where: str, rules: _Rules) -> tuple[Any, ...]:
    """A ``cls`` for each of the mapping's keys, which is its ``name``."""
    for name, rest in value.items():
        if not isinstance(rest, Mapping):
            raise rules.error(f"{where}.{name}: expected a mapping of keys to values, got {rest!r}")
    return tuple(
        _convert({"name": name, **rest}, cls, f"{where}.{name}", rules) for name, rest in value.items()
    )


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)


_SCALARS: Mapping[Any, Any] = {
    float: _is_number,
    int: lambda value: _is_number(value) and value == value // 1,
    bool: lambda value: isinstance(value, bool),
    str: lambda value: isinstance(value, str),
}
