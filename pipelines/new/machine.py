"""A new machine: everything that its case file, its README and the terminal say."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from hybridid.advice.decay import coasts, free_decay, settles, swing, undriven
from hybridid.advice.horizon import proposed_horizon
from hybridid.records.checks import MINIMUM_SAMPLES
from hybridid.records.record import Record
from hybridid.records.survey import TimeFound
from hybridid.records.usual_step import in_digits
from pipelines.new.columns import Chosen
from pipelines.new.scales import cutoff
from pipelines.new.template import Derivative, Template

FITTED_SHARE = 0.7
"""Of the only recording: what is fitted; the rest judges."""
FEW, SEVERAL = 6, 3
"""Oscillations of a record that nothing drives, at least, to judge by (a horizon of each), and at least to be
one."""
EDGE = 2.0
"""Periods of the cutoff at each end of a record over which a low-pass settles."""


@dataclass(frozen=True)
class Recording:
    """One recording: its record's name, its files as the case names them, its time axis, and the parameters
    that it gives."""

    name: str
    files: tuple[str, ...]
    time: TimeFound
    constants: Mapping[str, float]


@dataclass(frozen=True)
class Part:
    """A record of the case: the samples of a recording from ``start`` to ``stop`` in s (None: its own end);
    ``cut`` says whether they are not all, or signals are made of them."""

    name: str
    recording: Recording
    role: str
    start: float | None
    stop: float | None
    cut: bool


@dataclass(frozen=True)
class Machine:
    """What was found and written: everything that the case file, the README and the terminal say."""

    name: str
    folder: Path
    template: Template
    chosen: tuple[Chosen, ...]
    recordings: tuple[Recording, ...]
    records: tuple[Record, ...]
    simulated: bool = False

    @property
    def time(self) -> TimeFound:
        """The time axis of the first recording; all have the same column and unit."""
        return self.recordings[0].time

    @property
    def resample(self) -> float | None:
        """The even step in s, where the stamps of a recording are uneven."""
        uneven = [one.time.usual for one in self.recordings if not one.time.even]
        return in_digits(uneven) if uneven else None

    @property
    def parts(self) -> tuple[Part, ...]:
        """What each record of the case takes of which recording."""
        whole = [self._usable(record) for record in self.records]
        if self.split is None:
            roles = ["identification"] * max(1, len(whole) - 1) + ["validation"] * (len(whole) > 1)
            pairs = zip(self.recordings, whole, roles, strict=True)
            return tuple(
                Part(one.name, one, role, *span, bool(self.template.made)) for one, span, role in pairs
            )
        only, (start, stop) = self.recordings[0], whole[0]
        return (
            Part("fitted", only, "identification", start, self.split, True),
            Part("judging", only, "validation", self.split, stop, True),
        )

    def _usable(self, record: Record) -> tuple[float | None, float | None]:
        """The times in s between which the derivatives of a record are good, none of whose first and last
        samples are; None: the record's own end."""
        taken = [derivative for _, derivative in self.template.made if derivative.order > 0]
        if not taken:
            return None, None
        margin = EDGE / min(map(self.cutoff, taken))
        return _instant(record.time[0] + margin, record), _instant(record.time[-1] - margin, record)

    @property
    def split(self) -> float | None:
        """The time in s up to which the only recording is fitted; None where there are several, or the rest
        of what is usable is too short for a record."""
        record = self.records[0]
        at = record.time[0] + FITTED_SHARE * (record.time[-1] - record.time[0])
        end = self._usable(record)[1] or record.time[-1]
        if len(self.records) > 1 or (end - at) / record.dt < MINIMUM_SAMPLES:
            return None
        return _instant(at, record)

    @property
    def all_judge(self) -> bool:
        """Whether parts of all recordings are to judge: what is fitted is one free decay, which alone cannot
        tell a friction over the amplitude from one over the time; or the only recording has settled where it
        would judge, or is driven no more, or is too short to be divided; or the last one, which nothing
        drives, is too short to judge."""
        if self.split is not None:
            return settles(self.records[0], self.split) or coasts(self.records[0], self.split)
        if len(self.records) == 1 or any(free_decay(self.records[:-1])):
            return True
        judging, longest = self.records[-1], max(self.records, key=lambda one: one.n * one.dt)
        oscillates = SEVERAL * swing(longest) <= longest.n * longest.dt
        return undriven(judging) and oscillates and judging.n * judging.dt < FEW * swing(longest)

    def cutoff(self, derivative: Derivative) -> float:
        """Of the low-pass, in Hz, under which a derivative is taken."""
        return min(cutoff(record.signal(derivative.of), record.dt) for record in self.records)

    @property
    def horizon(self) -> float:
        """The horizon in s to fit and to judge by: 1 s, or 50 samples where sampling is slow. It is
        at most a tenth of the shortest recording, so that there are some to judge by, and as long as that
        where nothing drives the machine."""
        step = max(record.dt for record in self.records)
        shortest = min(record.time[-1] - record.time[0] for record in self.records)
        return proposed_horizon(step, shortest, all(map(undriven, self.records)))

    @property
    def horizon_samples(self) -> int | None:
        """The same in samples of the records as the case makes them. None, the whole record, where a state is
        hidden: each horizon has an initial state of its own, and what no output shows could fit it alone."""
        if self.template.hides:
            return None
        step = self.resample or max(record.dt for record in self.records)
        return max(2, round(self.horizon / step))


def _instant(time: float, record: Record) -> float:
    """A time in s, with as many decimals as the sampling time needs: stamps may count from 1970."""
    return round(float(time), max(0, math.ceil(-math.log10(record.dt))))
