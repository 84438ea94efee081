"""The checks that every ``Record`` passes when it is made."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Protocol

import numpy as np

from hybridid.records.channel import Array, Channel, RecordError, Signals
from hybridid.records.clipping import clipped_runs
from hybridid.records.masked import Cells, Counts
from hybridid.records.usual_step import in_digits, usual_step

MINIMUM_SAMPLES = 10
# Time stamps printed with too few digits deviate by less than this, a lost or late sample by more.
LARGEST = 1e60
"""Magnitude of a sample: beyond it products and squares leave the range of numbers."""
SHORTEST_STEP, LONGEST_STEP = 1e-12, 1e9
"""Sampling times in s: beyond them the unit of time is wrong."""
STEP_TOLERANCE = 0.01  # of the sampling time
# Small errors of the steps add up: beyond half a sample, a fit would take the sum for a delay.
GRID_TOLERANCE = 0.5  # of the sampling time
GAP = 3.0
"""Times the usual step from which on a step is a gap: what is resampled into it was not measured."""
ONE_STEP = 1e-6
"""Share of a step by which two are one, however long the records."""


class Sampled(Protocol):
    """A recording of ``n`` samples, one every ``dt`` s."""

    @property
    def n(self) -> int:
        """Number of samples."""

    @property
    def dt(self) -> float:
        """Sampling time in s."""


def have_one_step(one: Sampled, other: Sampled) -> bool:
    """Whether two recordings can be simulated with one step: over the shorter of them, stamps of the one step
    and of the other drift no farther apart than a stamp may from its even grid. Stamps that are rounded make
    such a difference between two parts of one recording."""
    allowed = max(GRID_TOLERANCE / min(one.n, other.n), ONE_STEP)
    return abs(one.dt - other.dt) <= allowed * min(one.dt, other.dt)


def check_samples(
    name: str, time: Array, signals: Sequence[Signals], cells: Cells | None = None
) -> tuple[str, ...]:
    """Warnings about the samples of record ``name``, each one line; ``time`` is (n,) in s.

    ``cells`` (n, n_y) says which of the outputs count; None: all.

    Raises:
        RecordError: if lengths or shapes disagree, there is no output, names repeat, there are fewer
            samples than ``MINIMUM_SAMPLES`` or fewer that count, a value is not finite, or time is not even
            and increasing.
    """
    where = f"record {name}"
    _check_shapes(time, signals, where)
    _check_names(signals, where)
    if len(time) < MINIMUM_SAMPLES:
        raise RecordError(f"{where}: {len(time)} samples are too few, at least {MINIMUM_SAMPLES} are needed")
    check_finite(time, "time", "s", where)
    check_increasing(time, where)
    _check_step(time, where)
    for role, channel, values in _each(signals):
        check_finite(values, f"{role} {channel.name!r}", channel.unit, where, time)
    check_even(time, where)
    if cells is not None:
        _check_cells(time, signals, cells, where)
    return tuple(_warnings(time, signals, where, cells))


def _check_cells(time: Array, signals: Sequence[Signals], cells: Cells, where: str) -> None:
    count = int(cells.any(axis=1).sum())
    if count < MINIMUM_SAMPLES:
        raise RecordError(
            f"{where}: {count} of {len(time)} samples count, at least {MINIMUM_SAMPLES} are needed: "
            "the mask leaves too few"
        )
    outputs = next(group for group in signals if group.role == "outputs")
    for channel, count in zip(outputs.channels, cells.sum(axis=0).tolist(), strict=True):
        if count < MINIMUM_SAMPLES:
            raise RecordError(
                f"{where}: output {channel.name!r} counts at {count} of {len(time)} samples, at least "
                f"{MINIMUM_SAMPLES} are needed"
            )


def check_finite(values: Array, what: str, unit: str, where: str, time: Array | None = None) -> None:
    """Raise if a value of ``values`` (n,) is missing, infinite or beyond ``LARGEST``, naming the first.

    Raises:
        RecordError: with the channel, how many, and the first one's sample and time.
    """
    bad = np.flatnonzero(~np.isfinite(values))
    if len(bad):
        k = int(bad[0])
        at = "" if time is None else f" (t = {time[k]:g} s)"
        kind = "missing (NaN)" if np.isnan(values[k]) else "infinite"
        raise RecordError(
            f"{where}: {what} [{unit}] is {kind} at sample {k}{at}, "
            f"{len(bad)} of {len(values)} samples are missing or infinite; repair or cut them first"
        )
    k = int(np.argmax(np.abs(values))) if len(values) else 0
    if len(values) and abs(values[k]) > LARGEST:
        raise RecordError(
            f"{where}: {what} [{unit}] is {values[k]:.3g} at sample {k}, no quantity of a machine: repair "
            "or cut it first, or give another unit or scale"
        )


def check_increasing(time: Array, where: str) -> None:
    """Raise if a time stamp of ``time`` (n,) repeats or runs backward, naming the worst.

    Raises:
        RecordError: with how many, and the worst step's samples and stamps.
    """
    steps = np.diff(time)
    rounding = 1e-6 * float(np.median(np.abs(steps)))  # 0.025 + 0.001 is slightly above 0.026
    wrong = steps <= rounding
    if wrong.any():
        k = int(np.argmin(steps))
        verb = "repeats" if abs(steps[k]) <= rounding else "runs backward"
        raise RecordError(
            f"{where}: time {verb} from sample {k} to {k + 1} ({time[k]:.9g} s to {time[k + 1]:.9g} s), "
            f"{int(wrong.sum())} of {len(steps)} steps do not advance; time stamps must increase"
        )


def set_resample(name: str, time: Array) -> str:
    """What to set so that the record ``name`` is resampled at the usual step of ``time`` (n,) in s, for a
    message."""
    dt = in_digits([usual_step(time)])
    return (
        f"set signals.resample={dt:.12g} to interpolate onto an even grid (records.{name}.resample for this "
        "record alone)"
    )


def leave_out(name: str, start: float, stop: float) -> str:
    """The step that leaves the samples of the record ``name`` from ``start`` to ``stop`` [s] out, for a
    message."""
    stretch = f"[[{start:.9g}, {stop:.9g}]]"
    return f"'records.{name}.steps=[{{step: mask, stretches: {stretch}, through: false}}]'"


def check_even(time: Array, where: str) -> None:
    """Raise if the increasing stamps ``time`` (n,) deviate from an even grid, naming the worst.

    Each step must be within ``STEP_TOLERANCE`` of the usual one, and each stamp within
    ``GRID_TOLERANCE`` of the even grid from the first stamp to the last.

    Raises:
        RecordError: with how many, where the worst is, and what to do.
    """
    steps = np.diff(time)
    dt = float(np.median(steps))
    resample = set_resample(where.removeprefix("record "), time)
    remedy = f"{resample}, or give signals.time.dt in place of its column if only the stamps are rounded"
    off = np.abs(steps - dt)
    if off.max() > STEP_TOLERANCE * dt:
        k = int(np.argmax(off))
        if steps[k] > GAP * dt:
            left_out = leave_out(where.removeprefix("record "), time[k], time[k + 1])
            remedy += f"; nothing was measured in that step, so leave it out too, by {left_out}"
        raise RecordError(
            f"{where}: time is uneven: step {steps[k]:.6g} s from sample {k} (t = {time[k]:g} s) "
            f"where {dt:.6g} s is usual, {int((off > STEP_TOLERANCE * dt).sum())} of {len(steps)} steps are "
            f"off by more than {STEP_TOLERANCE:.0%}; {remedy}"
        )
    drift = np.abs(time - np.linspace(time[0], time[-1], len(time)))
    if drift.max() > GRID_TOLERANCE * dt:
        k = int(np.argmax(drift))
        raise RecordError(
            f"{where}: time drifts {drift[k] / dt:.2g} samples away from an even grid of {dt:.6g} s "
            f"at sample {k} (t = {time[k]:g} s); {remedy}"
        )


def _check_step(time: Array, where: str) -> None:
    dt = float(np.median(np.diff(time)))
    if not SHORTEST_STEP <= dt <= LONGEST_STEP:
        raise RecordError(
            f"{where}: the sampling time is {dt:.3g} s, must be {SHORTEST_STEP:g} to {LONGEST_STEP:g} s; "
            "is the unit of time right?"
        )


def _check_shapes(time: Array, signals: Sequence[Signals], where: str) -> None:
    if time.ndim != 1:
        raise RecordError(f"{where}: time has shape {time.shape}, expected (n,)")
    for role, values, channels in signals:
        if values.ndim != 2 or values.shape[1] != len(channels):
            expected = f"(n, {len(channels)}), one column for each of its channels"
            raise RecordError(f"{where}: {role} have shape {values.shape}, expected {expected}")
        if len(values) != len(time):
            raise RecordError(f"{where}: lengths differ: time has {len(time)} samples, {role} {len(values)}")
    if not any(role == "outputs" and channels for role, _, channels in signals):
        raise RecordError(f"{where}: it has no output; at least one is needed")


def _check_names(signals: Sequence[Signals], where: str) -> None:
    names = ["time", *(channel.name for group in signals for channel in group.channels)]
    repeated = sorted({name for name in names if names.count(name) > 1})
    if repeated:
        raise RecordError(f"{where}: the name {repeated[0]!r} is taken twice (time is one of them)")


def _each(signals: Sequence[Signals]) -> Iterator[tuple[str, Channel, Array]]:
    """For every signal its role in the singular, its channel and its values (n,)."""
    for role, values, channels in signals:
        for j, channel in enumerate(channels):
            yield role.removesuffix("s").removesuffix(" signal"), channel, values[:, j]


def _counts(signals: Sequence[Signals], cells: Cells | None) -> Iterator[Counts | None]:
    """For every signal the samples at which it counts, (n,); None: all."""
    for role, _, channels in signals:
        for j in range(len(channels)):
            yield cells[:, j] if cells is not None and role == "outputs" else None


def _warnings(time: Array, signals: Sequence[Signals], where: str, cells: Cells | None) -> Iterator[str]:
    for (role, channel, values), counts in zip(_each(signals), _counts(signals, cells), strict=True):
        if role == "auxiliary" or channel.constant:  # no model uses it; it is meant
            continue
        seen = values if counts is None else values[counts]
        if seen.min() == seen.max():
            unseen = (
                "; a delay, a lag, a dead zone or a limit of the drive shows only where it changes: if the "
                "machine was at rest before, put the rest into the record, too"
                if role == "input" and seen[0] != 0.0
                else ""
            )
            yield f"{where}: {role} {channel.name!r} is constant ({seen[0]:g} {channel.unit}){unseen}"
            continue
        runs = clipped_runs(values)
        if counts is not None:
            runs = [run for run in runs if counts[slice(*run)].any()]
        if runs:
            start, stop = runs[0]
            times = "once" if len(runs) == 1 else f"{len(runs)} times"
            fine = "that is how it was commanded" if role == "input" else "it rests there"
            yield (
                f"{where}: {role} {channel.name!r} looks clipped: {times} it stops at its extreme, "
                f"first at {values[start]:g} {channel.unit} for {stop - start} samples "
                f"from t = {time[start]:g} s; fine if {fine}"
            )
