"""Remarks on records: those that say the same of several records become one line."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence

_NUMBER = re.compile(r"[+-]?\d+(\.\d+)?(e[+-]?\d+)?")


def together(remarks: Mapping[str, Sequence[str]]) -> list[str]:
    """The ``remarks`` by record, in order; of those that differ in their numbers only, the first, with how
    many records it stands for."""
    alike: dict[str, dict[str, str]] = {}
    for name, lines in remarks.items():
        for line in lines:
            said = line.removeprefix(f"record {name}: ")
            about = name if said != line else ""
            kind = said if not about else _NUMBER.sub("#", said)
            alike.setdefault(kind, {}).setdefault(about, said)
    return [line for said in alike.values() for line in _lines(said)]


def _lines(said: Mapping[str, str]) -> list[str]:
    """One line for what was ``said`` of each record, by name; a name of "" is of no record."""
    name, first = next(iter(said.items()))
    if not name:
        return [first]
    if len(said) == 1:
        return [f"record {name}: {first}"]
    return [f"{len(said)} records, the first {name}: {first}"]
