"""A section of a config: a dataclass whose fields are declared as settings (``hybridid.settings``)."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Mapping
from typing import Any

from hybridid.naming import unknown
from hybridid.settings import check, keys
from hybridid.settings.bounds import allowed, kind, options
from hybridid.settings.declare import hints_of, of_field

Convert = Callable[[Any, Any, str], Any]
"""``(value, type, dotted name) -> value`` of that type."""


def is_section(cls: Any) -> bool:
    """Whether the fields of a dataclass are declared as settings."""
    return any(of_field(field) for field in dataclasses.fields(cls))


def section(cls: Any, values: Any, where: str, error: type[ValueError], convert: Convert) -> Any:
    """``cls`` from the keys of the section called ``where`` (empty: the keys that stand in none).

    Raises:
        error: in one line for an unknown or missing key or a value that is not allowed, by its dotted name.
    """
    check_keys(cls, values, where, error)
    try:
        made = cls(**_fields(cls, values, where, error, convert))
        check(made, where)
    except ValueError as wrong:
        raise error(str(wrong)) from wrong
    return made


def check_keys(cls: Any, values: Any, where: str, error: type[ValueError]) -> None:
    """Whether ``values`` are a mapping whose keys are those of ``cls``.

    Raises:
        error: if not, in one line.
    """
    known = keys(cls)
    if not isinstance(values, Mapping):
        raise error(f"{where} is {values!r}: give {', '.join(known)}")
    for key in values:
        if key not in known:
            raise error(unknown(f"config key below {where}" if where else "config key", key, known))


def _fields(
    cls: Any, values: Mapping[str, Any], where: str, error: type[ValueError], convert: Convert
) -> dict[str, Any]:
    """The fields that ``values`` give."""
    found: dict[str, Any] = {}
    for field in dataclasses.fields(cls):
        hint, name = hints_of(cls)[field.name], f"{where}.{field.name}" if where else field.name
        if field.metadata.get("inline"):
            own = {key: value for key, value in values.items() if key in keys(hint)}
            found[field.name] = section(hint, own, where, error, convert)
        elif field.name in values:
            found[field.name] = _value(values[field.name], field, hint, name, error, convert)
        elif field.default is dataclasses.MISSING:
            raise error(f"{name} is missing: expected {kind(hint)}")
    return found


def _value(
    value: Any, field: dataclasses.Field[Any], hint: Any, name: str, error: type[ValueError], convert: Convert
) -> Any:
    """What a field is given; of another kind than a number within bounds, the message says these."""
    if value is None and type(None) not in options(hint) and hint is not Any:
        raise error(f"{name} is null: expected {kind(hint)}")
    try:
        return convert(_as_text(value, hint), hint, name)
    except error:
        declared = of_field(field)
        bounds = allowed(declared, hint) if declared and hint in (int, float) else ""
        if bounds.startswith("must be a "):
            raise error(f"{name} is {value!r}: {bounds}") from None
        raise


def _as_text(value: Any, hint: Any) -> Any:
    """A number as text where text may stand, but no number: a folder or a record may be called 2024."""
    own = options(hint)
    if isinstance(value, list) and tuple[str, ...] in own:
        return [_as_text(item, str) for item in value]
    if (
        isinstance(value, int | float)
        and not isinstance(value, bool)
        and str in own
        and not {int, float} & set(own)
    ):
        return str(value)
    return value
