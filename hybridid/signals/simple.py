"""Cutting, shifting and scaling."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from hybridid.records.record import Record
from hybridid.signals.step import Step, StepError, in_place

EDGE = 1e-6  # of a sample; a time stamp may differ this much from a bound by rounding


@dataclass(frozen=True)
class Crop(Step):
    """The samples with ``start <= t < stop`` [s], or those from ``samples[0]`` to before ``samples[1]``.

    Half-open: parts that share a bound have no sample in common. Time stamps are kept.
    """

    start: float | None = None
    stop: float | None = None
    samples: tuple[int, int] | None = None

    def __post_init__(self) -> None:
        by_time = self.start is not None or self.stop is not None
        if by_time == (self.samples is not None):
            raise StepError("give start and/or stop in seconds, or samples: [first, end]")
        if self.samples is not None and not 0 <= self.samples[0] < self.samples[1]:
            raise StepError(f"samples {list(self.samples)} must be rising and not negative")
        if self.start is not None and self.stop is not None and self.start >= self.stop:
            raise StepError(f"start {self.start:g} s is not before stop {self.stop:g} s")

    def apply(self, record: Record) -> Record:
        first, end = self.samples or self._bounds(record)
        if first >= end or end > record.n:
            raise StepError(
                f"samples {first} to {end} are not in record {record.name}: it has {record.n} samples, "
                f"from {record.time[0]:g} s to {record.time[-1]:g} s"
            )
        return record.part(first, end)

    def _bounds(self, record: Record) -> tuple[int, int]:
        lower = -np.inf if self.start is None else self.start - EDGE * record.dt
        upper = np.inf if self.stop is None else self.stop - EDGE * record.dt
        return int(np.searchsorted(record.time, lower)), int(np.searchsorted(record.time, upper))


@dataclass(frozen=True)
class RemoveMean(Step):
    """``x - mean(x)``, with the mean over ``over: [start, stop]`` [s] if given, for example a rest. Samples
    that a mask before it leaves out are no part of the mean."""

    signals: tuple[str, ...]
    over: tuple[float, float] | None = None

    @property
    def touched(self) -> tuple[str, ...]:
        return self.signals

    def apply(self, record: Record) -> Record:
        start, stop = self.over or (-np.inf, np.inf)
        inside = (record.time >= start) & (record.time <= stop) & record.counts
        if not inside.any():
            raise StepError(f"no sample of record {record.name} lies from {start:g} s to {stop:g} s")
        return in_place(record, self.signals, lambda x: x - x[inside].mean())


@dataclass(frozen=True)
class Offset(Step):
    """``x + value``, in the signal's unit."""

    signals: tuple[str, ...]
    value: float

    @property
    def touched(self) -> tuple[str, ...]:
        return self.signals

    def apply(self, record: Record) -> Record:
        return in_place(record, self.signals, lambda x: x + self.value)


@dataclass(frozen=True)
class Scale(Step):
    """``factor · x``; give ``unit`` if the unit changes."""

    signals: tuple[str, ...]
    factor: float
    unit: str | None = None

    def __post_init__(self) -> None:
        if self.factor == 0:
            raise StepError("factor is 0, which leaves no signal")

    @property
    def touched(self) -> tuple[str, ...]:
        return self.signals

    def apply(self, record: Record) -> Record:
        scaled = in_place(record, self.signals, lambda x: self.factor * x, self.unit)
        channels = tuple(
            replace(c, noise=abs(self.factor) * c.noise) if c.name in self.signals else c
            for c in scaled.output_channels
        )
        return replace(scaled, output_channels=channels)
