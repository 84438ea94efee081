"""``Entry``: a measured record with what its publishers found, and the traces that are asked of it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import yaml

from hybridid.plain import build
from pipelines.shared.errors import ConfigError

FILE = "entry.yaml"
HERE = Path(__file__).parent


@dataclass(frozen=True)
class Judge:
    """The free run that is reported: ``measure`` of ``output``, the mean over ``records`` (None: all that are
    held out)."""

    output: str
    records: tuple[str, ...] | None = None
    measure: Literal["rmse", "mae"] = "rmse"


@dataclass(frozen=True)
class Published:
    """The ``physics`` that others found, and the smallest ``error`` that they report ``of`` a model in the
    judge's measure, in its unit."""

    physics: str
    error: float | None = None
    of: str = ""
    source: str = ""


@dataclass(frozen=True)
class Entry:
    """A ``case`` with further ``options``. ``declared`` are its effects, as ``effects=[...]`` takes them;
    ``lacks`` names the effects any of which would be what others found missing beside them. ``data`` is the
    choice of the config's key ``data``."""

    title: str
    case: str
    declared: tuple[str, ...]
    lacks: tuple[str, ...]
    judge: Judge
    published: Published
    options: tuple[str, ...] = ()
    data: str = "measured"
    name: str = ""


@dataclass(frozen=True)
class Asked:
    """One trace of an entry: with all that is declared, or without the effect ``left_out``."""

    entry: Entry
    left_out: str = ""

    @property
    def key(self) -> str:
        """``emps/declared``, ``emps/without coulomb``."""
        return f"{self.entry.name}/{self.label}"

    @property
    def label(self) -> str:
        """``declared``, ``without coulomb``."""
        return f"without {self.left_out.partition('@')[0]}" if self.left_out else "declared"

    @property
    def effects(self) -> tuple[str, ...]:
        """The declared ones that are left."""
        return tuple(effect for effect in self.entry.declared if effect != self.left_out)

    @property
    def wanted(self) -> tuple[str, ...]:
        """Ids of effects any of which is known to be missing: the one left out, else what others found."""
        return (self.left_out.partition("@")[0],) if self.left_out else self.entry.lacks


def entries(folder: Path = HERE) -> list[Entry]:
    """The entry of each folder in ``folder`` that has one.

    Raises:
        ConfigError: if a file does not fit; names the key.
    """
    return [_read(file) for file in sorted(folder.glob(f"*/{FILE}"))]


def asked_of(entry: Entry) -> list[Asked]:
    """The traces of an entry."""
    return [Asked(entry), *(Asked(entry, effect) for effect in entry.declared)]


def every(found: Sequence[Entry]) -> list[Asked]:
    """The traces of all entries."""
    return [asked for entry in found for asked in asked_of(entry)]


def _read(file: Path) -> Entry:
    content = yaml.safe_load(file.read_text(encoding="utf-8"))
    return build(Entry, {**content, "name": file.parent.name}, str(file), ConfigError)
