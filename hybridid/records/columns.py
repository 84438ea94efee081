"""The columns of a recorded file, and how one is found by name."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import final

from hybridid.naming import unknown
from hybridid.records.channel import Array, RecordError


@final
@dataclass(frozen=True)
class Columns(Mapping[str, Array]):
    """The columns of numbers in one file, by name; ``unusable`` says why another column is not.

    ``instants`` are the columns of dates or durations: they are in s, and serve as time alone. Of a column
    whose samples have stamps of their own, ``clocks`` names the column that holds these.
    """

    path: Path
    values_by_name: Mapping[str, Array]
    unusable: Mapping[str, str]
    instants: frozenset[str] = frozenset()
    clocks: Mapping[str, str] = field(default_factory=dict)

    def __getitem__(self, name: str) -> Array:
        """The column ``name``, (n,), or (1,) for a scalar.

        Raises:
            RecordError: if the file has no such column of numbers; gives the nearest name.
        """
        if name in self.values_by_name:
            return self.values_by_name[name]
        if name in self.unusable:
            raise RecordError(f"{self.path}: {name!r} cannot be a signal: {self.unusable[name]}")
        parts = [one for one in (*self, *self.unusable) if one.startswith((f"{name}[", f"{name}."))]
        if name and parts:
            raise RecordError(
                f"{self.path}: {name!r} has {len(parts)} parts, {parts[0]} to {parts[-1]}: name one of them"
            )
        raise RecordError(f"{self.path}: {unknown('column', name, self.values_by_name)}")

    def __contains__(self, name: object) -> bool:
        return name in self.values_by_name

    def __iter__(self) -> Iterator[str]:
        return iter(self.values_by_name)

    def __len__(self) -> int:
        return len(self.values_by_name)


def joined(tables: Sequence[Columns]) -> Columns:
    """The columns of all files of one recording. A name that several of ``tables`` have becomes
    ``file:column``, as ``find_column`` takes it."""
    if len(tables) == 1:
        return tables[0]
    held = Counter(name for table in tables for name in (*table, *table.unusable))
    stems = Counter(table.path.stem for table in tables)

    def told(table: Columns, name: str) -> str:
        file = table.path.stem if stems[table.path.stem] == 1 else table.path.name
        return name if held[name] == 1 else f"{file}:{name}"

    return Columns(
        Path(", ".join(str(table.path) for table in tables)),
        {told(table, name): values for table in tables for name, values in table.items()},
        {told(table, name): why for table in tables for name, why in table.unusable.items()},
        frozenset(told(table, name) for table in tables for name in table.instants),
        {told(table, a): told(table, b) for table in tables for a, b in table.clocks.items()},
    )


def find_column(name: str, tables: Sequence[Columns]) -> Array:
    """The column of numbers called ``name``, or ``file:name``, in any of ``tables``.

    Raises:
        RecordError: if none of them has it, or more than one, or if it holds dates or durations.
    """
    table, own = _found(name, tables)
    if own in table.instants:
        raise RecordError(
            f"{table.path}: {own!r} cannot be a signal: it holds dates or durations, as time does"
        )
    return table[own]


def find_time(name: str, tables: Sequence[Columns]) -> tuple[Array, bool]:
    """As ``find_column``, also for dates and durations; the second says whether it holds them, in s.

    Raises:
        RecordError: if no table has it, or more than one.
    """
    table, own = _found(name, tables)
    return table[own], own in table.instants


def clock_of(name: str, tables: Sequence[Columns]) -> tuple[Path, str] | None:
    """The file and the column that hold the stamps of the column ``name``; None where it has none of its own.

    Raises:
        RecordError: if no table has it, or more than one.
    """
    table, own = _found(name, tables)
    clock = own if own in table.clocks.values() else table.clocks.get(own)
    return None if clock is None else (table.path, clock)


def _found(name: str, tables: Sequence[Columns]) -> tuple[Columns, str]:
    """The one table that has the column, and its name there."""
    holders = [table for table in tables if name in table]
    if len(holders) == 1:
        return holders[0], name
    if holders:
        among = ", ".join(f"{table.path.stem}:{name}" for table in holders)
        raise RecordError(f"column {name!r} is in {len(holders)} files; say which: {among}")
    file, _, rest = name.partition(":")
    for table in tables:
        if rest and file in (table.path.name, table.path.stem):
            return table, rest
    for table in tables:
        if name in table.unusable or len(tables) == 1:
            return table, name  # whose [] says why it has none
    where = ", ".join(table.path.name for table in tables)
    raise RecordError(f"{where}: {unknown('column', name, [column for table in tables for column in table])}")
