"""``new``: from recordings and a template to a folder with a case, a plant and a README."""

from __future__ import annotations

import importlib.util
import os
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from hybridid.records.channel import Hold, RecordError
from hybridid.records.columns import Columns, joined
from hybridid.records.mapping import SignalMap, TimeMap, build_record
from hybridid.records.readers import read_columns
from hybridid.records.record import Record
from hybridid.records.survey import NoTimeError, TimeFound, columns_found, time_found
from hybridid.records.usual_step import in_digits
from pipelines.new.absent import UNDRIVEN
from pipelines.new.columns import NONE, Ask, Chosen, chosen, full_name
from pipelines.new.machine import Machine, Recording
from pipelines.new.pages import text_of
from pipelines.new.scales import StillError, scales
from pipelines.new.template import Template, template
from pipelines.shared.errors import ConfigError, unknown
from pipelines.shared.tree import discard_unfinished, replacing, write_text


@dataclass(frozen=True)
class Request:
    """What the user asks for: the files of each recording; columns (``none``: the machine lacks the signal),
    scales and holds by signal; the column of ``time`` or the ``rate`` in Hz, where the files do not tell it.
    ``constants`` are columns that hold one number, by the parameter that it is. ``simulated``: the files hold
    no measurement."""

    folder: Path
    recordings: tuple[tuple[Path, ...], ...]
    template: str
    signals: Mapping[str, str] = field(default_factory=dict)
    scales: Mapping[str, float] = field(default_factory=dict)
    holds: Mapping[str, Hold] = field(default_factory=dict)
    constants: Mapping[str, str] = field(default_factory=dict)
    time: str | None = None
    time_unit: str | None = None
    rate: float | None = None
    simulated: bool = False


def new(request: Request, ask: Ask) -> Machine:
    """Write the folder ``request.folder``. Whatever is wrong, nothing is written.

    Raises:
        ConfigError: if the folder exists, its name cannot be a plant's, or a signal has no column.
        RecordError: if a recording cannot be read, has no time axis, or fails the checks of a record.
    """
    name = _name_of(request.folder)
    plan = template(request.template)
    _check_signals(plan, request)
    tables = [joined([read_columns(path) for path in paths]) for paths in request.recordings]
    times = [_time_of(table, request) for table in tables]
    apart = {(time.column, time.unit) for time in times}
    if len(apart) > 1:
        raise RecordError(f"the recordings have different time columns: {sorted(map(str, apart))}")
    clocks = (times[0].column, *times[0].same)
    found = [one for one in columns_found(tables[0]) if one.name not in clocks]
    picked = chosen(plan, found, request.signals, request.scales, ask, tables[0].unusable)
    plan = _without(plan, picked)
    _check_absent(plan, request)
    picked = tuple(_with_gaps(_with_hold(one, plan, request), plan, tables) for one in picked)
    times = [_aligned(time, table, picked) for time, table in zip(times, tables, strict=True)]
    names = _record_names(request.recordings)
    here = request.folder.resolve()
    recordings = tuple(
        Recording(
            record, tuple(_address(path.resolve(), here) for path in paths), time, _constants(table, request)
        )
        for record, paths, time, table in zip(names, request.recordings, times, tables, strict=True)
    )
    records = tuple(
        _read(name, paths, time, plan, picked)
        for name, paths, time in zip(names, request.recordings, times, strict=True)
    )
    machine = Machine(name, request.folder, plan, picked, recordings, records, request.simulated)
    _write(machine)
    return machine


def _time_of(table: Columns, request: Request) -> TimeFound:
    """The time axis of a recording; where nothing tells it, the options that do."""
    try:
        named = None if request.time is None else full_name(request.time, table)
        return time_found(table, named, 1 / request.rate if request.rate else None, request.time_unit)
    except NoTimeError as open_question:
        raise ConfigError(f"{open_question}. Give --time COLUMN, or --rate HZ") from open_question


def _aligned(time: TimeFound, table: Columns, picked: tuple[Chosen, ...]) -> TimeFound:
    """``time``, uneven where a signal has stamps of its own: resampling aligns it, too."""
    own = any(table.clocks.get(one.column.name, time.column) != time.column for one in picked)
    return replace(time, even=time.even and not own)


def _address(path: Path, folder: Path) -> str:
    """The file as the case in ``folder`` names it: from there, if they may move together."""
    return os.path.relpath(path, folder) if path.is_relative_to(folder.parent) else str(path)


def _name_of(folder: Path) -> str:
    """The machine's name, which its Python module and its case have too."""
    name = folder.name
    if not re.fullmatch(r"[a-z][a-z0-9_]*", name):
        raise ConfigError(f"{name!r} is no name of a machine: small letters, digits and _, a letter first")
    if folder.exists():
        raise ConfigError(f"{folder} exists already: give another name; nothing is overwritten")
    if not folder.absolute().parent.is_dir():
        raise ConfigError(f"{folder.parent}: no such folder")
    if importlib.util.find_spec(name) is not None:
        raise ConfigError(f"{name} is already the name of a Python library: give another one")
    return name


def _check_signals(plan: Template, request: Request) -> None:
    known = [signal.name for signal in (*plan.inputs, *plan.outputs)]
    parameters = [parameter.name for parameter in plan.plant.parameters]
    for given in request.constants:
        if given not in parameters:
            raise ConfigError(unknown(f"parameter of template {plan.kind}", given, parameters))
    for given in request.holds:
        if given not in [signal.name for signal in plan.inputs]:
            raise ConfigError(f"{given!r} is no input of template {plan.kind}, so it has no hold")
    for given in (*request.signals, *request.scales):
        if given not in known and given not in request.constants:
            raise ConfigError(f"template {plan.kind} has no signal {given!r}; it has {', '.join(known)}")


def _without(plan: Template, picked: Sequence[Chosen]) -> Template:
    """The template without the signals for which no column was picked."""
    taken = [one.signal for one in picked]
    return plan.without([one for one in (*plan.inputs, *plan.outputs) if one not in taken])


def _check_absent(plan: Template, request: Request) -> None:
    for signal in plan.absent:
        if signal.name in (*request.scales, *request.holds):
            raise ConfigError(f"signal {signal.name} is none, so it has no scale and no hold")


def _constants(table: Columns, request: Request) -> dict[str, float]:
    """The parameters that a recording gives, in the parameters' units."""
    found = {}
    for parameter, said in request.constants.items():
        column = full_name(said, table)
        values = table[column]
        if not np.ptp(values) == 0:  # nan is no constant either
            raise ConfigError(
                f"--constant {parameter}={column}: {table.path} has {np.min(values):g} to {np.max(values):g} "
                "there, no constant"
            )
        found[parameter] = float(f"{values[0] * request.scales.get(parameter, 1.0):.9g}")
    return found


def _with_hold(one: Chosen, plan: Template, request: Request) -> Chosen:
    """An input with the hold that the user gave, or that its samples show."""
    if one.signal not in plan.inputs:
        return one
    return replace(one, hold=request.holds.get(one.signal.name, "zoh" if one.column.held else None))


def _with_gaps(one: Chosen, plan: Template, tables: Sequence[Columns]) -> Chosen:
    """An output that says whether cells of it are missing."""
    gaps = any(np.isnan(table[one.column.name]).any() for table in tables)
    return replace(one, gaps=gaps and one.signal in plan.outputs)


def _record_names(recordings: tuple[tuple[Path, ...], ...]) -> list[str]:
    """A name for each recording, after its first file."""
    names = [re.sub(r"\W+", "_", paths[0].stem).strip("_").lower() or "record" for paths in recordings]
    return [n if names.count(n) == 1 else f"{n}_{i}" for i, n in enumerate(names, 1)]


def _read(
    name: str, paths: tuple[Path, ...], time: TimeFound, plan: Template, picked: tuple[Chosen, ...]
) -> Record:
    """The recording as the case will read it, so that what is written works."""
    signals = {
        one.signal.name: SignalMap(
            one.signal.name,
            one.signal.unit,
            one.column.name,
            one.scale,
            hold=one.hold,
            missing="mask" if one.gaps else "refuse",
        )
        for one in picked
    }
    axis = TimeMap(dt=time.step)
    if time.column is not None:
        axis = TimeMap(time.column, time.unit, same=time.same)
    inputs, outputs = ([signals[one.name] for one in ours] for ours in (plan.inputs, plan.outputs))
    resample = None if time.even else in_digits([time.usual])
    return build_record(name, paths, axis, inputs, outputs, resample=resample)


def _scales(machine: Machine) -> dict[str, float]:
    """The magnitudes at the head of the plant's file; a driving signal that is zero is better none."""
    lackable = [one.name for one in machine.template.inputs if one.name in machine.template.about.without]
    try:
        return scales(machine.template.about.scales, machine.records)
    except StillError as still:
        told = f". If {UNDRIVEN}, give --signal {still.signal}={NONE}" if still.signal in lackable else ""
        raise ConfigError(f"{still}{told}") from still


def _write(machine: Machine) -> None:
    code = machine.template.code(machine.name, _scales(machine))
    case, about = text_of("case.yaml", machine), text_of("README.md", machine)
    discard_unfinished(machine.folder)
    with replacing(machine.folder) as folder:
        (folder / "case").mkdir()
        write_text(folder / "case" / f"{machine.name}.yaml", case)
        write_text(folder / f"{machine.name}.py", code)
        write_text(folder / "README.md", about)
