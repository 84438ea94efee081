"""The sources of a case's records: measured files if they are found, else the case's virtual rig."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from fnmatch import fnmatchcase
from pathlib import Path
from typing import Any, Protocol, TypeVar

from hybridid.demand import Demand
from hybridid.naming import listed, no_file_name, shortened
from hybridid.records.mapping import RecordMap, planned_record, record_map
from hybridid.records.record import Record, RecordError
from hybridid.records.sources import DataRoot, RecordNotFoundError, data_roots, digest_of, locate
from hybridid.records.survey import other_unit_of_time
from hybridid.rigs.rig import Rig
from hybridid.signals.step import StepError, as_steps
from pipelines.shared.by_record import parameters_by_record
from pipelines.shared.config import Settings
from pipelines.shared.errors import ConfigError, unknown
from pipelines.shared.imports import code_digests
from pipelines.shared.rigs import rig_of
from pipelines.shared.sections.stages import ArchiveSection, FitSection, RigSection

KEYS = ("data", "records", "signals", "rig", "paths.data")
ROLES = ("identification", "validation")
_OWN = ("role", "run", "steps", "parameters")
_STANDS_IN = "no measured record found; the virtual rig simulates them, so all results are SIMULATED"


@dataclass(frozen=True)
class Measured:
    """A record whose files were found. ``constants`` are the parameters that it gives."""

    name: str
    role: str
    plan: RecordMap
    files: tuple[Path, ...]
    steps: tuple[Any, ...] = ()
    constants: Mapping[str, float] = field(default_factory=dict)

    @property
    def digest(self) -> str:
        """SHA-256 of the files."""
        return digest_of(self.files)

    def record(self) -> Record:
        """Read the record from its files."""
        record, doubt = planned_record(self.name, self.plan, self.files), other_unit_of_time(self.plan.time)
        return replace(record, warnings=(*record.warnings, doubt)) if doubt else record


@dataclass(frozen=True)
class Simulated:
    """A record that the case's virtual rig makes. ``constants`` are the parameters that it gives."""

    name: str
    role: str
    rig: Rig
    run: str
    seed: int
    duration: float | None
    steps: tuple[Any, ...] = ()
    constants: Mapping[str, float] = field(default_factory=dict)

    @property
    def digest(self) -> str:
        """Digest of the rig, its truth and the settings of the run."""
        return self.rig.digest(self.run, self.seed, self.duration)

    @property
    def demand(self) -> Demand:
        """What the run needs.

        Raises:
            RigError: for a bad duration.
        """
        return self.rig.demand(self.run, self.seed, self.duration)

    def record(self) -> Record:
        """Simulate the record."""
        return replace(self.rig.record(self.run, self.seed, self.duration), name=self.name, warnings=())


Source = Measured | Simulated


class HasRole(Protocol):
    """A record with a name and a role."""

    @property
    def name(self) -> str:
        """The record's name in the config."""

    @property
    def role(self) -> str:
        """``identification`` or ``validation``."""


Named = TypeVar("Named", bound=HasRole)


@dataclass(frozen=True)
class Sources:
    """The sources of a case's records; ``remarks`` warn of records that are missing or simulated."""

    found: tuple[Source, ...]
    remarks: tuple[str, ...] = ()

    @property
    def simulated(self) -> bool:
        """Whether any record comes from the virtual rig."""
        return any(isinstance(source, Simulated) for source in self.found)


def sources_of(settings: Settings) -> Sources:
    """The case's records under ``data``: measured, simulated, or ``auto``.

    ``auto`` takes the measured records that are found; if none is found, the rig simulates all. A case
    without a rig needs them all.

    Raises:
        ConfigError: if the config of records, signals or rig is wrong.
        RecordNotFoundError: if a record is missing and ``data`` is ``measured``, or the case has no rig.
    """
    choice = settings.lone.data
    records = _records(settings)
    parameters_by_record(settings)
    if choice == "simulated":
        return Sources(_simulated(settings, records), ("simulated records, as data=simulated asks",))
    roots = roots_of(settings.paths.data, settings.folders)
    if not roots[0].path.is_dir() and settings.paths.data:
        raise ConfigError(f"paths.data is {roots[0].path}: no such folder")
    found, missing = [], []
    for name, entry in records.items():
        try:
            found.append(_measured(settings, name, entry, roots))
        except RecordNotFoundError as error:
            missing.append(f"record {name}: {error}")
    if not missing:
        return Sources(tuple(found))
    if choice == "measured" or settings.get("rig") is None:
        raise RecordNotFoundError(f"{missing[0]}{_fetch_hint(settings)}")
    if found:
        return Sources(tuple(found), tuple(missing))
    return Sources(_simulated(settings, records), (missing[0], f"{_STANDS_IN}{_fetch_hint(settings)}"))


def roots_of(data: str | None, folders: Sequence[Path]) -> tuple[DataRoot, ...]:
    """The folders searched for records: ``paths.data``, ``$HYBRIDID_DATA``, ``data/raw``, the user's own."""
    return (*data_roots(data), *(DataRoot(folder, "--config-dir") for folder in folders))


def digests(settings: Settings) -> dict[str, str]:
    """Digests that identify the records, by name; for simulated records also the code of their rig."""
    sources = sources_of(settings)
    rig = code_digests([str(settings["rig"]["path"])]) if sources.simulated else {}
    return {f"record {s.name}": f"{type(s).__name__.lower()} {s.digest}" for s in sources.found} | rig


def chosen(records: Sequence[Named], wanted: Sequence[str] | None, key: str) -> list[Named]:
    """The records whose name or role is in ``wanted``, or matches a pattern there; all if it is None.

    A pattern has ``*``, as in ``sin_sin*``.

    Raises:
        ConfigError: if an entry matches no record; the message names the config key ``key``.
    """
    if wanted is None:
        return list(records)
    known = {word for record in records for word in (record.name, record.role)}
    for entry in wanted:
        if not any(fnmatchcase(word, entry) for word in known):
            raise ConfigError(unknown(f"record in {key}:", entry, known))
    return [r for r in records if any(fnmatchcase(word, e) for e in wanted for word in (r.name, r.role))]


def fitted_records(records: Sequence[Named], settings: Settings) -> list[Named]:
    """The records that the model is fitted to, as ``chosen`` by the key ``fit.records``."""
    return chosen(records, settings.section("fit", FitSection).records, "fit.records")


def _records(settings: Settings) -> dict[str, dict[str, Any]]:
    given = settings.get("records")
    if not isinstance(given, Mapping) or not all(isinstance(entry, Mapping) for entry in given.values()):
        raise ConfigError(f"case {settings.case}: records must map names to files and role")
    for name, entry in given.items():
        if complaint := no_file_name(str(name)):
            raise ConfigError(f"record {shortened(repr(str(name)), 80)}: {complaint}")
        if set(entry) <= {"resample", "steps", "simulated"} and len(given) > 1:  # of the command line alone
            raise ConfigError(unknown("record", str(name), [one for one in given if one != name]))
        if entry.get("role") not in ROLES:
            raise ConfigError(unknown(f"role of record {name}:", str(entry.get("role")), ROLES))
    return {str(name): dict(entry) for name, entry in given.items()}


def _measured(
    settings: Settings, name: str, entry: Mapping[str, Any], roots: tuple[DataRoot, ...]
) -> Measured:
    plan = _plan(settings, name, entry)
    files = tuple(locate(file, roots) for file in plan.files)
    return Measured(name, entry["role"], plan, files, _steps(name, entry), _constants(entry))


def _plan(settings: Settings, name: str, entry: Mapping[str, Any]) -> RecordMap:
    """What ``signals`` and the record's own entry say about its files and columns."""
    signals = settings.get("signals", {})
    if not isinstance(signals, Mapping):
        raise ConfigError(f"signals is {signals!r}: give time, inputs and outputs, each with its columns")
    own = {key: value for key, value in entry.items() if key not in _OWN}
    try:
        return record_map({**signals, **own}, f"record {name}")
    except RecordError as error:
        raise ConfigError(str(error)) from error


def _constants(entry: Mapping[str, Any]) -> dict[str, float]:
    """The parameters that a record gives; ``by_record`` has checked them."""
    return {str(name): float(value) for name, value in (entry.get("parameters") or {}).items()}


def _steps(name: str, entry: Mapping[str, Any]) -> tuple[Any, ...]:
    try:
        return as_steps(entry.get("steps"), f"records.{name}.steps")
    except StepError as error:
        raise ConfigError(str(error)) from error


def _simulated(settings: Settings, records: Mapping[str, Mapping[str, Any]]) -> tuple[Simulated, ...]:
    if settings.get("rig") is None:
        raise ConfigError(f"data=simulated: case {settings.case} has no virtual rig")
    section, rig = settings.section("rig", RigSection), rig_of(settings["rig"])
    made = []
    for name, entry in records.items():
        run = str(entry.get("run", name))
        if run not in rig.runs:
            raise ConfigError(unknown(f"run of rig {rig.name}, for record {name}:", run, rig.runs))
        if "files" in entry or settings.get("signals") is not None:
            _rehearsed(_plan(settings, name, entry), name, rig)
        own = _steps(name, entry)
        given = _constants(entry)
        made.append(Simulated(name, entry["role"], rig, run, section.seed or 0, section.duration, own, given))
    return tuple(made)


def _rehearsed(plan: RecordMap, name: str, rig: Rig) -> None:
    """Whether the rig gives the signals that ``signals`` declares: what stands in for a measured record is
    refused where that would be.

    Raises:
        ConfigError: if their names or units differ.
    """
    pairs = (("inputs", plan.inputs, rig.input_channels), ("outputs", plan.outputs, rig.output_channels))
    for what, declared, channels in pairs:
        asked = [f"{one.name} [{one.unit}]" for one in declared]
        given = [f"{one.name} [{one.unit}]" for one in channels]
        if asked != given:
            raise ConfigError(
                f"record {name}: signals declares the {what} {listed(asked)}, rig {rig.name} simulates "
                f"{listed(given)}"
            )


def _fetch_hint(settings: Settings) -> str:
    public = settings.section("archive", ArchiveSection).name
    return f"; hybridid fetch {settings.case} downloads the measured ones" if public else ""
