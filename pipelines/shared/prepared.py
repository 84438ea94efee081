"""``preprocess/records.json``: the records that ``preprocess`` wrote, and the files of their samples."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from hybridid.declarations import Signal, State
from hybridid.records.channel import Channel
from pipelines.shared.storage import read_as

RECORDS = "preprocess/records.json"


@dataclass(frozen=True)
class NamedUnit:
    """A signal's name and unit."""

    name: str
    unit: str

    @classmethod
    def each(cls, signals: Sequence[Channel] | Sequence[Signal] | Sequence[State]) -> tuple[NamedUnit, ...]:
        """Name and unit of each signal."""
        return tuple(cls(signal.name, signal.unit) for signal in signals)


@dataclass(frozen=True)
class Prepared:
    """A record that ``preprocess`` wrote: ``n`` samples every ``dt`` s.

    ``file`` lies in the run tree; ``role`` is what the case uses the record for, ``provenance`` "measured"
    or "simulated", ``source`` where it comes from, ``digest`` the SHA-256 of its data. ``masked`` is how many
    samples do not count.
    """

    name: str
    role: str
    provenance: str
    file: Path
    source: str
    digest: str
    n: int
    dt: float
    inputs: tuple[NamedUnit, ...]
    outputs: tuple[NamedUnit, ...]
    auxiliary: tuple[NamedUnit, ...]
    warnings: tuple[str, ...]
    masked: int = 0

    @property
    def seconds(self) -> float:
        """The duration in s of what counts of the record."""
        return (self.n - self.masked) * self.dt


def prepared_records(tree: Path) -> list[Prepared]:
    """The records of a run tree, with the paths of their files."""
    return [replace(one, file=tree / one.file) for one in read_as(tuple[Prepared, ...], tree / RECORDS)]


def provenance_of(tree: Path) -> str:
    """Provenance of a run tree's records: ``measured``, ``simulated``, or ``measured and simulated``."""
    return " and ".join(sorted({record.provenance for record in prepared_records(tree)}))
