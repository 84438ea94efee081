"""From plain mappings, as a config holds them, to frozen dataclasses.

A mistake costs the user one line: where it is, what is allowed, and the nearest right name.
"""

from __future__ import annotations

import dataclasses
import types
import typing
from collections.abc import Mapping, Sequence
from typing import Any, Literal, TypeVar, Union

from hybridid.naming import unknown

T = TypeVar("T")


def build(cls: type[T], values: Mapping[str, Any], where: str, error: type[ValueError]) -> T:
    """A dataclass ``cls`` from a plain mapping, converted by its field types.

    Understood are numbers, text, booleans, ``Literal``, optional values, tuples (a lone value
    stands for a tuple of one) and dataclasses. A tuple of dataclasses may also be written as
    a mapping from their ``name`` to the rest, which is easier to override from a command line.

    Raises:
        error: for an unknown or missing key or a value of the wrong kind, in one line that
            starts with ``where``; so for a ``ValueError`` that ``cls`` itself raises.
    """
    if not isinstance(values, Mapping):
        raise error(f"{where}: expected a mapping of keys to values, got {values!r}")
    fields = {f.name: f for f in dataclasses.fields(cls) if f.init}  # type: ignore[arg-type]
    for key in values:
        if key not in fields:
            raise error(f"{where}: {unknown('key', key, fields)}")
    for name, f in fields.items():
        required = f.default is dataclasses.MISSING and f.default_factory is dataclasses.MISSING
        if required and values.get(name) is None:
            raise error(f"{where}: key {name!r} is missing; keys: {', '.join(fields)}")
    hints = typing.get_type_hints(cls)
    converted = {key: _convert(value, hints[key], f"{where}: {key}", error) for key, value in values.items()}
    try:
        return cls(**converted)
    except ValueError as wrong:
        raise error(f"{where}: {wrong}") from wrong


def _convert(value: Any, hint: Any, where: str, error: type[ValueError]) -> Any:
    """``value`` as the annotation ``hint`` asks."""
    origin, arguments = typing.get_origin(hint), typing.get_args(hint)
    if origin in (Union, types.UnionType):
        return _convert_union(value, arguments, where, error)
    if origin is Literal:
        if value not in arguments:
            raise error(f"{where} is {value!r}: allowed: {', '.join(map(str, arguments))}")
        return value
    if origin is tuple:
        return _convert_tuple(value, arguments, where, error)
    if dataclasses.is_dataclass(hint) and isinstance(hint, type):
        return value if isinstance(value, hint) else build(hint, value, where, error)
    if hint in _SCALARS and _SCALARS[hint](value):
        return float(value) if hint is float else value
    if hint in _SCALARS:
        raise error(f"{where} is {value!r}: expected {_WORDS[hint]}")
    return value


def _convert_union(value: Any, options: tuple[Any, ...], where: str, error: type[ValueError]) -> Any:
    """The first of ``options`` that fits; the complaint of the first if none does."""
    if value is None and type(None) in options:
        return None
    complaints: list[ValueError] = []
    for option in options:
        if option is not type(None):
            try:
                return _convert(value, option, where, error)
            except error as wrong:
                complaints.append(wrong)
    raise complaints[0]


def _convert_tuple(
    value: Any, items: tuple[Any, ...], where: str, error: type[ValueError]
) -> tuple[Any, ...]:
    if isinstance(value, Mapping) and dataclasses.is_dataclass(items[0]):
        nested = all(isinstance(v, Mapping) for v in value.values())
        value = [{"name": name, **rest} for name, rest in value.items()] if nested else [value]
    if isinstance(value, str) or not isinstance(value, Sequence):
        value = [value]
    if items[-1] is Ellipsis:
        items = (items[0],) * len(value)
    if len(value) != len(items):
        raise error(f"{where} has {len(value)} values, expected {len(items)}")
    pairs = enumerate(zip(value, items, strict=True))
    return tuple(_convert(v, item, f"{where}[{i}]", error) for i, (v, item) in pairs)


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)


_SCALARS: Mapping[Any, Any] = {
    float: _is_number,
    int: lambda value: isinstance(value, int) and not isinstance(value, bool),
    bool: lambda value: isinstance(value, bool),
    str: lambda value: isinstance(value, str),
}
_WORDS: Mapping[Any, str] = {float: "a number", int: "a whole number", bool: "true or false", str: "text"}
