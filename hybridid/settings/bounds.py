"""Whether settings are within what is allowed, and what is allowed, in words."""

from __future__ import annotations

import dataclasses
import math
import types
import typing
from collections.abc import Iterator, Mapping
from typing import Any, Literal, Union

from hybridid.naming import nearest
from hybridid.settings.declare import Setting, hints_of, of_field

_KINDS: Mapping[Any, str] = {
    float: "a number",
    int: "a whole number",
    bool: "true or false",
    str: "text",
    type(None): "null",
}


def check(instance: Any, where: str) -> None:
    """Whether the settings of a dataclass hold words and numbers that are allowed.

    Raises:
        ValueError: if not, in one line that starts with the dotted name ``where.field``, or the field alone.
    """
    for field in dataclasses.fields(instance):
        found = of_field(field)
        if found:
            _check(
                getattr(instance, field.name),
                hints_of(instance.__class__)[field.name],
                found,
                f"{where}.{field.name}" if where else field.name,
            )


def options(hint: Any) -> tuple[Any, ...]:
    """The types that a union allows, or the one type."""
    if typing.get_origin(hint) in (Union, types.UnionType):
        return typing.get_args(hint)
    return (hint,)


def words_of(hint: Any) -> tuple[str, ...]:
    """The words that may be chosen, also inside a tuple: of ``Literal`` and of booleans."""
    return tuple(_words(hint))


def kind(hint: Any) -> str:
    """The type in words, such as ``a whole number or null``."""
    origin, arguments = typing.get_origin(hint), typing.get_args(hint)
    if origin is Literal:
        return ", ".join(map(str, arguments))
    if origin in (Union, types.UnionType):
        lists = any(typing.get_origin(argument) is tuple for argument in arguments)
        return (", or " if lists else " or ").join(map(kind, arguments))
    if origin is tuple and arguments[-1] is Ellipsis:
        return f"a list, each {kind(arguments[0])}"
    if origin is tuple:
        return f"a list of {len(arguments)}, each {kind(arguments[0])}"
    return _KINDS.get(hint, "a mapping of keys to values")


def allowed(setting: Setting, hint: Any) -> str:
    """The bounds in words, such as ``at least 2 samples``; empty if there are none."""
    number = kind(int) if int in options(hint) else kind(float)
    unit = f" {setting.unit}" if setting.unit else ""
    least, most, above, below = setting.least, setting.most, setting.above, setting.below
    if above == 0 and below in (None, math.inf) and most is None:
        return f"must be a positive number of{unit}" if unit else "must be positive"
    if above is not None and below is not None:
        return f"must lie between {above:g} and {below:g}{unit}"
    if above is not None and most is not None:
        return f"must be above {above:g} and at most {bound(most)}{unit}"
    if least is not None and most is not None:
        return f"must be {number} from {least:g} to {bound(most)}{unit}"
    if above is not None:
        return f"must be above {above:g}{unit}"
    if least is not None:
        return f"at least {least:g}{unit}"
    return ""


def bound(value: float) -> str:
    """A bound as a person writes it: ``2^63 - 1`` for the largest number of a seed."""
    power = int(value).bit_length() if isinstance(value, int) else 0
    return f"2^{power} - 1" if power > 32 and value == 2**power - 1 else f"{value:g}"


def _words(hint: Any) -> Iterator[str]:
    origin, arguments = typing.get_origin(hint), typing.get_args(hint)
    if hint is bool:
        yield from ("true", "false")
    elif origin is Literal:
        yield from map(str, arguments)
    elif origin in (Union, types.UnionType, tuple):
        for argument in arguments:
            yield from _words(argument)


def _check(value: Any, hint: Any, setting: Setting, where: str) -> None:
    if isinstance(value, str):
        if setting.some and not value.strip():
            null = f", or null for {setting.null}" if setting.null else ""
            raise ValueError(f"{where} is {value!r}: give {setting.shown or 'a name'}{null}")
        known = [
            w for option in options(hint) if typing.get_origin(option) is Literal for w in _words(option)
        ]
        if known and str not in options(hint) and value not in known:
            raise ValueError(f"{where} is {value!r}: {nearest(value, known)}allowed: {', '.join(known)}")
    elif isinstance(value, tuple | list):
        if setting.some and not value:
            words = words_of(hint)
            raise ValueError(f"{where} is []: give at least one{' of ' + ', '.join(words) if words else ''}")
        inner = next((o for o in options(hint) if typing.get_origin(o) is tuple), Any)
        for item, own in zip(value, _item_hints(inner, len(value)), strict=False):
            _check(item, own, setting, where)
    elif value is not None and not isinstance(value, bool | Mapping) and not _within(value, setting):
        null = f", or null for {setting.null}" if setting.null else ""
        raise ValueError(f"{where} is {value!r}: {allowed(setting, hint)}{null}")


def _item_hints(hint: Any, count: int) -> tuple[Any, ...]:
    arguments = typing.get_args(hint)
    if not arguments:
        return (Any,) * count
    return (arguments[0],) * count if arguments[-1] is Ellipsis else arguments


def _within(value: Any, setting: Setting) -> bool:
    least, most, above, below = setting.least, setting.most, setting.above, setting.below
    return (
        (least is None or value >= least)
        and (most is None or value <= most)
        and (above is None or value > above)
        and (below is None or value < below)
    )
