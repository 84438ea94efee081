"""A new machine: everything that its case file, its README and the terminal say."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from hybridid.records.record import Record
from hybridid.records.survey import TimeFound
from pipelines.new.columns import Chosen
from pipelines.new.template import Template

FITTED_SHARE = 0.7
"""Of the only recording: what is fitted; the rest judges."""
LONG_STEP = 0.05  # s; with a longer one, 1 s holds too few samples for a horizon
STEPS = 50
"""Samples of a horizon, where the sampling is slow."""


@dataclass(frozen=True)
class Recording:
    """One recording: its record's name, its file as the case names it, its time axis, and the parameters that
    it gives."""

    name: str
    file: str
    time: TimeFound
    constants: Mapping[str, float]


@dataclass(frozen=True)
class Machine:
    """What was found and written: everything that the case file, the README and the terminal say."""

    name: str
    folder: Path
    template: Template
    chosen: tuple[Chosen, ...]
    recordings: tuple[Recording, ...]
    records: tuple[Record, ...]

    @property
    def time(self) -> TimeFound:
        """The time axis of the first recording; all have the same column and unit."""
        return self.recordings[0].time

    @property
    def resample(self) -> float | None:
        """The even step in s, where the stamps of a recording are uneven."""
        uneven = [one.time.step for one in self.recordings if not one.time.even]
        return float(f"{min(uneven):.2g}") if uneven else None

    @property
    def split(self) -> float | None:
        """The time in s up to which the only recording is fitted; None where there are several."""
        record = self.records[0]
        if len(self.records) > 1:
            return None
        return float(f"{record.time[0] + FITTED_SHARE * (record.time[-1] - record.time[0]):.4g}")

    @property
    def horizon(self) -> float | None:
        """The horizon in s to judge by, where 1 s holds too few samples."""
        step = max(record.dt for record in self.records)
        return float(f"{STEPS * step:.2g}") if step > LONG_STEP else None
