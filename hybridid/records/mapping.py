"""Makes a ``Record`` from the columns of recorded files: which column is which signal, in what unit."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from hybridid.naming import shortened, unknown
from hybridid.plain import build
from hybridid.records.absent import Missing, gap_of, on_grid
from hybridid.records.channel import Array, Channel, Hold, RecordError
from hybridid.records.checks import check_finite, set_resample
from hybridid.records.columns import Columns, clock_of, find_column, find_time
from hybridid.records.readers import read_columns
from hybridid.records.record import Record
from hybridid.records.resample import KEPT, Resample, resampled
from hybridid.records.sensor_noise import rounding_of
from hybridid.records.sources import DataRoot, digest_of, locate

LONGEST = 60
"""Characters of a signal's name and of a unit."""
SECONDS: Mapping[str, float] = {
    "s": 1.0,
    "ms": 1e-3,
    "us": 1e-6,
    "µs": 1e-6,
    "ns": 1e-9,
    "min": 60,
    "h": 3600,
}


@dataclass(frozen=True)
class SignalMap:
    """``signal = sign · scale · factor · column + offset``, in ``unit``.

    ``factor`` names a scalar or a column of the same files (EMPS: force [N] = ``gtau`` · ``vir``).
    ``offset`` is in ``unit``. If several files have a column of that name, write ``file:column``
    with the file's name or stem. Without a ``hold`` an input is assumed to be held constant (``zoh``).
    ``missing`` says what becomes of cells without a number: ``refuse`` ends the command, ``mask`` leaves them
    out (of an output alone), ``interpolate`` draws a straight line (in an auxiliary signal alone). ``noise``
    is the standard deviation of an output's noise, in ``unit``. Give that of each output, and a fit weighs
    each error by it; else by the output's own standard deviation.
    """

    name: str
    unit: str
    column: str
    scale: float = 1.0
    sign: int = 1
    offset: float = 0.0
    factor: str | None = None
    hold: Hold | None = None
    meaning: str = ""
    missing: Missing = "refuse"
    noise: float | None = None

    def __post_init__(self) -> None:
        if not self.name.isprintable() or not 0 < len(self.name) <= LONGEST:
            name = shortened(repr(self.name), 80)
            raise RecordError(f"{name} is no name of a signal: 1 to {LONGEST} characters in one line")
        if not self.unit.isprintable() or len(self.unit) > LONGEST:
            raise RecordError(
                f"unit is {shortened(repr(self.unit), 80)}: at most {LONGEST} characters in one line"
            )
        if not self.column:
            raise RecordError("column is empty: give the name of a column")
        if self.sign not in (1, -1):
            raise RecordError(f"sign is {self.sign}, allowed: 1, -1")
        if self.scale == 0 or not np.isfinite([self.scale, self.offset]).all():
            raise RecordError(
                f"scale is {self.scale:g} and offset {self.offset:g}: must be finite, and scale not 0"
            )
        if self.noise is not None and not 0 < self.noise < np.inf:
            raise RecordError(f"noise is {self.noise:g}, a standard deviation must be positive")

    @property
    def channel(self) -> Channel:
        """The channel that the signal becomes in the record."""
        return Channel(
            self.name,
            self.unit,
            self.hold or "zoh",
            self.meaning,
            assumed=self.hold is None,
            noise=self.noise or 0.0,
        )


@dataclass(frozen=True)
class TimeMap:
    """The time axis: a ``column`` of stamps in ``unit``, or a known ``dt`` [s] or ``rate`` [Hz].

    With ``dt`` or ``rate`` time starts at 0. ``same`` lists further time columns (of the other
    files of one record) that must agree with ``column``.
    """

    column: str | None = None
    unit: str = "s"
    dt: float | None = None
    rate: float | None = None
    same: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        given = [name for name in ("column", "dt", "rate") if getattr(self, name) is not None]
        if len(given) != 1:
            got = ", ".join(given) or "none"
            raise RecordError(f"time needs exactly one of column, dt, rate, got {got}")
        if self.unit not in SECONDS:
            raise RecordError(unknown("unit", self.unit, SECONDS))
        step = self.dt if self.dt is not None else self.rate
        if step is not None and not 0 < step < np.inf:
            raise RecordError(f"{given[0]} is {step:g}, it must be positive")
        if self.same and self.column is None:
            raise RecordError("same compares with column, which is not given")


@dataclass(frozen=True)
class RecordMap:
    """Everything that a config says about one recording. A machine may have no input: one that swings freely.
    ``simulated``: the files hold no measurement, but what some program computed; every result says so.

    Raises:
        RecordError: if it names no file or no output, or two signals share a name.
    """

    files: tuple[str, ...]
    time: TimeMap
    outputs: tuple[SignalMap, ...]
    inputs: tuple[SignalMap, ...] = ()
    auxiliary: tuple[SignalMap, ...] = ()
    resample: Resample | float | None = None
    simulated: bool = False

    def __post_init__(self) -> None:
        if not self.files:
            raise RecordError("files is empty: name at least one")
        if not self.outputs:
            raise RecordError("outputs is empty: at least one is needed")
        names = ["time", *(s.name for s in (*self.inputs, *self.outputs, *self.auxiliary))]
        for name in names:
            if names.count(name) > 1:
                raise RecordError(f"the name {name!r} is taken twice (time is one of them)")
        for signal in (*self.inputs, *self.auxiliary):
            if signal.noise is not None:
                raise RecordError(f"{signal.name}: noise is allowed for an output alone")
        if isinstance(self.resample, int | float):
            object.__setattr__(self, "resample", Resample(self.resample))


def record_map(values: Mapping[str, Any], where: str = "record") -> RecordMap:
    """A ``RecordMap`` from plain keys and values, as a config holds them.

    Raises:
        RecordError: in one line, for an unknown or missing key or a value that is not allowed.
    """
    return build(RecordMap, values, where, RecordError)


def read_record(name: str, plan: RecordMap, roots: Sequence[DataRoot | Path | str]) -> Record:
    """The record that ``plan`` describes, its files found under ``roots``.

    Raises:
        RecordNotFoundError: if a file is under none of the roots.
        RecordError: as ``build_record``.
    """
    return planned_record(name, plan, [locate(file, roots) for file in plan.files])


def planned_record(name: str, plan: RecordMap, files: Sequence[Path]) -> Record:
    """The record that ``plan`` describes, from its ``files``.

    Raises:
        RecordError: as ``build_record``.
    """
    made = build_record(name, files, plan.time, plan.inputs, plan.outputs, plan.auxiliary, plan.resample)
    return replace(made, simulated=plan.simulated)


def build_record(
    name: str,
    files: Sequence[Path | str],
    time: TimeMap,
    inputs: Sequence[SignalMap],
    outputs: Sequence[SignalMap],
    auxiliary: Sequence[SignalMap] = (),
    resample: Resample | float | None = None,
) -> Record:
    """One ``Record`` from the columns of one or several files.

    Raises:
        RecordError: if a file or column is missing or misnamed, lengths differ, or the record
            does not pass its own check. Uneven time stamps pass if ``resample`` is given.
    """
    paths = [Path(file) for file in files]
    if not paths:
        raise RecordError(f"record {name}: it names no file")
    tables = [read_columns(path) for path in paths]
    signals = [*inputs, *outputs, *auxiliary]
    if not signals:
        raise RecordError(f"record {name}: it names no signal")
    found = [_signal(signal, tables) for signal in signals]
    stamps = _stamps(time, tables, len(found[0]))
    clocks = _clocks(name, time, signals, tables, resample is not None)
    if clocks is None:
        _check_lengths(name, stamps, signals, found)
    roles = ["inputs"] * len(inputs) + ["outputs"] * len(outputs) + ["auxiliary"] * len(auxiliary)
    own = [stamps] * len(signals) if clocks is None else clocks
    gaps = [gap_of(name, s, role, v, at) for s, role, v, at in zip(signals, roles, found, own, strict=True)]
    values = [gap.filled for gap in gaps]
    warnings: tuple[str, ...] = tuple(gap.said for gap in gaps if gap.said)
    absent = [gap.absent for gap in gaps]
    channels = [signal.channel for signal in signals]
    if resample is not None:
        plan = resample if isinstance(resample, Resample) else Resample(resample)
        holds = [s.channel.hold if i < len(inputs) else None for i, s in enumerate(signals)]
        _check_finite(name, stamps, signals, values)
        rounded = [KEPT * rounding_of(column) for column in values]
        channels = [replace(one, rounding=std) for one, std in zip(channels, rounded, strict=True)]
        stamps, values, remarks = resampled(stamps, values, holds, plan, f"record {name}", clocks)
        absent = [on_grid(stamps, at, cells) for at, cells in zip(own, absent, strict=True)]
        warnings = (*warnings, *remarks)
    n_u, n_y = len(inputs), len(inputs) + len(outputs)
    return Record(
        name=name,
        time=stamps,
        inputs=_matrix(values[:n_u], len(stamps)),
        outputs=_matrix(values[n_u:n_y], len(stamps)),
        input_channels=tuple(channels[:n_u]),
        output_channels=tuple(channels[n_u:n_y]),
        auxiliary=_matrix(values[n_y:], len(stamps)) if auxiliary else None,
        auxiliary_channels=tuple(channels[n_y:]),
        source=", ".join(map(str, paths)),
        digest=digest_of(paths),
        warnings=warnings,
        absent=np.column_stack(absent[n_u:n_y]),
    )


def _matrix(columns: Sequence[Array], n: int) -> Array:
    return np.column_stack(columns) if columns else np.empty((n, 0))


def _signal(signal: SignalMap, tables: Sequence[Columns]) -> Array:
    """The samples of one signal in its unit, (n,)."""
    column = find_column(signal.column, tables)
    factor = find_column(signal.factor, tables) if signal.factor else np.ones(1)
    if len(factor) not in (1, len(column)):
        raise RecordError(
            f"signal {signal.name!r}: factor {signal.factor!r} has {len(factor)} values, "
            f"column {signal.column!r} {len(column)}; they must be as many, or one"
        )
    return signal.sign * signal.scale * factor * column + signal.offset


def _stamps(time: TimeMap, tables: Sequence[Columns], n: int) -> Array:
    """Time stamps in s: (n,) with ``dt`` or ``rate``, else as many as the column has."""
    if time.column is None:
        count = np.arange(n, dtype=float)
        return count * time.dt if time.dt is not None else count / (time.rate or 1.0)
    stamps, in_seconds = find_time(time.column, tables)
    if in_seconds and time.unit != "s":
        raise RecordError(
            f"time column {time.column!r} holds dates or durations, which are read in s: "
            f"unit {time.unit!r} is not allowed"
        )
    for other in time.same:
        also, _ = find_time(other, tables)
        if len(also) != len(stamps) or not np.allclose(also, stamps, rtol=1e-9, atol=1e-9):
            raise RecordError(f"time columns {time.column!r} and {other!r} differ: not recorded together")
    return stamps * SECONDS[time.unit]


def _clocks(
    name: str, time: TimeMap, signals: Sequence[SignalMap], tables: Sequence[Columns], resampling: bool
) -> list[Array] | None:
    """The stamps of each signal in s, each (n,), where they are not all those of ``time``; else None.

    Raises:
        RecordError: if they differ and the record is not ``resampling``, or have no clock in common.
    """
    own = [clock_of(signal.column, tables) for signal in signals]
    of_time = own[0] if time.column is None else clock_of(time.column, tables)
    other = next((k for k, clock in enumerate(own) if clock != of_time), None)
    if other is None:
        return None
    signal, clock = signals[other], own[other]
    said = f"record {name}: signal {signal.name!r}"
    if of_time is None or clock is None or clock[0] != of_time[0]:
        raise RecordError(f"{said} and time have no clock in common: take both from one bag")
    if time.column is None or time.column.rpartition(":")[2] != of_time[1]:
        raise RecordError(f"{said} is stamped by {clock[1]}: set time.column to stamps, as {of_time[1]}")
    table = next(table for table in tables if table.path == clock[0])
    stamps = [table[one[1]] for one in own if one is not None]
    if all(len(one) == len(table[of_time[1]]) and np.array_equal(one, table[of_time[1]]) for one in stamps):
        return None
    if not resampling:
        raise RecordError(
            f"{said} is stamped by {clock[1]} ({len(table[clock[1]])} samples), time is {of_time[1]} "
            f"({len(table[of_time[1]])}): {set_resample(name, table[of_time[1]])}"
        )
    return stamps


def _check_lengths(name: str, stamps: Array, signals: Sequence[SignalMap], values: Sequence[Array]) -> None:
    lengths = {"time": len(stamps), **{s.name: len(v) for s, v in zip(signals, values, strict=True)}}
    if len(set(lengths.values())) > 1:
        listed = ", ".join(f"{signal} {n}" for signal, n in lengths.items())
        raise RecordError(f"record {name}: lengths differ: {listed} samples")


def _check_finite(name: str, stamps: Array, signals: Sequence[SignalMap], values: Sequence[Array]) -> None:
    """Runs before resampling, which would spread a missing value over its neighbours."""
    where = f"record {name}"
    check_finite(stamps, "time", "s", where)
    for signal, column in zip(signals, values, strict=True):
        check_finite(column, f"signal {signal.name!r}", signal.unit, where, stamps)
