"""Masking: parts of a record that do not count."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from hybridid.records.masked import APART, COUNTS, THROUGH, Counts, runs
from hybridid.records.record import Record
from hybridid.signals.simple import EDGE
from hybridid.signals.step import Step, StepError


@dataclass(frozen=True)
class Where:
    """The samples at which ``signal`` is ``below`` or ``above`` a value, or ``equals`` it."""

    signal: str
    below: float | None = None
    above: float | None = None
    equals: float | None = None

    def __post_init__(self) -> None:
        given = [word for word in ("below", "above", "equals") if getattr(self, word) is not None]
        if len(given) != 1:
            raise StepError(f"give one of below, above, equals; got {', '.join(given) or 'none'}")

    def chosen(self, record: Record) -> Counts:
        """Which samples of ``record`` it names, (n,)."""
        values = record.signal(self.signal)
        if self.below is not None:
            return values < self.below
        return values > self.above if self.above is not None else values == self.equals


@dataclass(frozen=True)
class _Masking(Step):
    """What ``mask`` and ``keep`` share: which samples are named."""

    stretches: tuple[tuple[float, float], ...] | None = None
    where: Where | None = None
    margin: float = 0.0
    through: bool = True

    def __post_init__(self) -> None:
        if (self.stretches is None) == (self.where is None):
            raise StepError(
                "give stretches: [[start, stop], ...] in seconds, or where: {signal: ..., below: ...}"
            )
        if self.stretches is not None and not self.stretches:
            raise StepError("stretches is []: give at least one [start, stop]")
        for start, stop in self.stretches or ():
            if not start < stop:
                raise StepError(f"stretches: start {start:g} s is not before stop {stop:g} s")
        if not 0 <= self.margin < np.inf:
            raise StepError(f"margin is {self.margin:g} s, it must be 0 or more")

    @property
    def touched(self) -> tuple[str, ...]:
        return () if self.where is None else (self.where.signal,)

    def _named(self, record: Record) -> Counts:
        """The samples in ``stretches`` or at which ``where`` holds, (n,)."""
        if self.where is not None:
            return self.where.chosen(record)
        found = np.zeros(record.n, dtype=bool)
        for start, stop in self.stretches or ():
            edge = EDGE * record.dt
            inside = (record.time >= start - edge) & (record.time < stop - edge)
            if not inside.any():
                raise StepError(
                    f"no sample of record {record.name} lies from {start:g} s to {stop:g} s: it runs from "
                    f"{record.time[0]:g} s to {record.time[-1]:g} s"
                )
            found |= inside
        return found

    def _masked(self, record: Record, masked: Counts) -> Record:
        """``record`` with ``masked`` (n,) and the margin about them masked, beside what was masked before."""
        reach = round(self.margin / record.dt)
        wider = np.array(masked)
        for first, end in runs(masked):
            if masked[first]:
                wider[max(first - reach, 0) : end + reach] = True
        levels = np.where(wider, THROUGH if self.through else APART, COUNTS).astype(np.int8)
        return record.with_masked(np.maximum(record.levels, levels))


@dataclass(frozen=True)
class Mask(_Masking):
    """Samples that do not count: those in ``stretches`` (``start <= t < stop`` [s]), or those ``where`` a
    signal is ``below`` or ``above`` a value or ``equals`` it; and up to ``margin`` [s] before and after them.

    They stay on the time axis, but are no part of the cost, the scores and the noise. With ``through``, the
    simulation runs through them with the recorded inputs, and effects keep their inner states: right for a
    sensor that saturates or drops out. Not so where a record begins with them, or where they last longer than
    a horizon: inner states begin anew after those. ``through: false`` ends the simulation before them and
    starts it anew after them: right where the machine moved otherwise than the inputs say, as by hand.
    Several masks add up.
    """

    def apply(self, record: Record) -> Record:
        return self._masked(record, self._named(record))


@dataclass(frozen=True)
class Keep(_Masking):
    """The inverse of ``mask``: all other samples do not count. ``margin`` [s] is taken from what is kept."""

    def apply(self, record: Record) -> Record:
        return self._masked(record, ~self._named(record))
