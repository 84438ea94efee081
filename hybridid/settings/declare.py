"""One setting: a field of a frozen dataclass with its default, bounds, unit and meaning.

    @dataclass(frozen=True)
    class Validation:
        horizon: float = setting(1.0, "length of each short run", unit="s", above=0)

What is declared here once, the checks, the help, the completion and the configuration reference use.
"""

from __future__ import annotations

import dataclasses
import typing
from collections.abc import Iterator
from functools import cache
from typing import Any

REQUIRED: Any = dataclasses.MISSING
"""The default of a setting that must be given."""
_METADATA = "setting"


@dataclasses.dataclass(frozen=True)
class Setting:
    """What is known of a setting beside its type and its default.

    A number is at ``least`` and at ``most``, or ``above`` and ``below``; so is each entry of a tuple, and
    ``some`` says that there is one, or that a text is not empty. ``null`` says what null stands for,
    ``follows`` from which other key the config takes the default, ``shown`` what stands for a value in the
    help.
    """

    meaning: str
    unit: str = ""
    least: float | None = None
    most: float | None = None
    above: float | None = None
    below: float | None = None
    some: bool = False
    null: str = ""
    follows: str = ""
    shown: str = ""


@dataclasses.dataclass(frozen=True)
class Declared:
    """A setting with its dotted ``name`` below its section, its type ``hint`` and its default."""

    name: str
    hint: Any
    default: Any
    setting: Setting


def setting(default: Any, meaning: str, **known: Any) -> Any:
    """A dataclass field with this default (``REQUIRED``: none); ``known`` as ``Setting`` names it."""
    return dataclasses.field(default=default, metadata={_METADATA: Setting(meaning, **known)})


def inlined(default: Any) -> Any:
    """A field that holds a dataclass whose settings stand among those of the section, not below a key of
    their own."""
    return dataclasses.field(default=default, metadata={"inline": True})


def of_field(field: dataclasses.Field[Any]) -> Setting | None:
    """How a field is declared, if it is a setting."""
    found: Setting | None = field.metadata.get(_METADATA)
    return found


@cache
def hints_of(cls: Any) -> dict[str, Any]:
    """The type of each field."""
    return typing.get_type_hints(cls)


def keys(cls: Any) -> dict[str, dataclasses.Field[Any]]:
    """The fields that a config may give, by key.

    They are those declared as settings; where a dataclass declares none, all of them.
    """
    fields = [f for f in dataclasses.fields(cls) if f.init]
    own = [f for f in fields if of_field(f) or f.metadata.get("inline")] or fields
    found: dict[str, dataclasses.Field[Any]] = {}
    for field in own:
        if field.metadata.get("inline"):
            found |= keys(hints_of(cls)[field.name])
        else:
            found[field.name] = field
    return found


def declared(cls: Any, prefix: str = "") -> Iterator[Declared]:
    """Every setting of a section, those of dataclasses inside it too."""
    for field in dataclasses.fields(cls):
        hint, found = hints_of(cls)[field.name], of_field(field)
        if field.metadata.get("inline"):
            yield from declared(hint, prefix)
        elif dataclasses.is_dataclass(hint):
            yield from declared(hint, f"{prefix}{field.name}.")
        elif found:
            yield Declared(f"{prefix}{field.name}", hint, field.default, found)
