"""The search from the gray box to the report."""

from __future__ import annotations

import time
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from pipelines.runner import run_stages
from pipelines.shared.config import Settings
from pipelines.shared.errors import ConfigError
from pipelines.shared.limits import check_demand, check_processes
from pipelines.shared.modelling import fit_settings, model_of
from pipelines.shared.pool import Lost, core_count, side_by_side
from pipelines.shared.prepared import prepared_records, provenance_of
from pipelines.shared.storage import json_text, read_json
from pipelines.shared.tree import write_text
from pipelines.shared.watch import Watcher
from pipelines.tracking.parent_run import parent_run
from pipelines.tune.findings import Findings, findings_of
from pipelines.tune.log import log_trial
from pipelines.tune.report import written
from pipelines.tune.request import TuneRequest, gray_settings, study_digest, with_values
from pipelines.tune.study import counts, opened
from pipelines.tune.trial import narx_of
from pipelines.tune.worker import WorkerTask, work

_NAME = "tune"


@dataclass(frozen=True)
class TuneOutcome:
    """The result of a search. ``folder`` holds its journal and report, ``lost`` why workers ended early."""

    findings: Findings
    request: TuneRequest
    folder: Path
    provenance: str
    seconds: float
    lost: tuple[str, ...] = ()


def tune(settings: Settings, watcher: Watcher) -> TuneOutcome:
    """Search until there are enough trials, or the time is up; the trials of an earlier command are kept.

    Raises:
        ConfigError: before anything is done, if the request cannot be carried out.
    """
    request = TuneRequest.of(settings)
    _check(settings, request)
    began = time.time()
    outcome = run_stages(gray_settings(settings), "fit", watcher)
    data = {record.name: record.digest for record in prepared_records(outcome.tree)}
    digest = study_digest(settings, request, data)
    folder = _folder(settings, digest, provenance_of(outcome.tree))
    _claim(folder, digest)
    key = f"{_NAME}.{digest}"
    study = opened(folder, request)
    there = sum(counts(trial) for trial in study.trials)
    if there:
        watcher.say(f"continues a search: {there} of {request.trials} trials are done in {folder}")
    until = None if request.seconds is None else began + request.seconds
    given = WorkerTask(settings, outcome.tree, folder, key, until)
    with parent_run(settings, _NAME, key, watcher) as parent:
        parent.open({"tree": str(folder)})
        lost = _searched(given, min(request.processes or core_count(), request.trials - there), watcher)
        findings = findings_of(opened(folder, request))
        tuned = TuneOutcome(findings, request, folder, provenance_of(outcome.tree), time.time() - began, lost)
        for row in findings.rows:
            log_trial(settings, row, key, watcher)
        files = written(findings, settings, folder, tuned.provenance)
        parent.close(bool(findings.of("failed") or lost), _metrics(findings), files)
    return tuned


def _check(settings: Settings, request: TuneRequest) -> None:
    """Whether networks can be made at the ends of every range."""
    check_processes(request.processes, "tune.processes", settings)
    for values in request.corners():
        asked = narx_of(settings, values)
        model = model_of(with_values(settings, values))
        asked.check(model)
        check_demand(asked.demand(model, (), fit_settings(settings)), settings)
        for name in ("depth", "width"):
            given = getattr(asked, name)
            if len(given) > 1:
                raise ConfigError(
                    f"residual.{name} is {list(given)}: one number, or vary it (tune.space.residual.{name})"
                )


def _folder(settings: Settings, digest: str, provenance: str) -> Path:
    """``out``, else ``paths.outputs``/<case>/tune-<digest>; a virtual rig's says so."""
    if settings.get("out") is not None:
        return Path(str(settings["out"]))
    name = f"{_NAME}-{digest}" + ("" if provenance == "measured" else "-simulated")
    return settings.outputs / settings.case / name


def _claim(folder: Path, digest: str) -> None:
    """Make the folder this search's own.

    Raises:
        ConfigError: if it is another's.
    """
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / "search.json"
    if path.exists() and (of := read_json(path)["digest"]) != digest:
        raise ConfigError(
            f"{folder} holds the search {of}, this one is {digest}: give another folder by out="
        )
    write_text(path, json_text({"digest": digest}))


def _searched(given: WorkerTask, processes: int, watcher: Watcher) -> tuple[str, ...]:
    """Run the workers until each has ended; returns those that were killed, and how."""
    if processes < 1:
        return ()
    names = {f"worker {k}": given for k in range(1, processes + 1)}
    states: dict[str, str] = {}
    lost = []
    for name, outcome in side_by_side(work, names, processes, lambda n: _WorkerWatcher(n, states, watcher)):
        states.pop(name, None)
        if isinstance(outcome, Lost):
            lost.append(f"{name}: {outcome.reason}")
            watcher.warn(lost[-1])
    return tuple(lost)


def _metrics(findings: Findings) -> Mapping[str, float]:
    found = {f"trials.{state}": float(len(findings.of(state))) for state in ("done", "pruned", "failed")}
    if findings.chosen is not None:
        found["tune.share"] = float(findings.chosen.share or 0.0)
        found["tune.trial"] = float(findings.chosen.number)
    return found


@dataclass(frozen=True)
class _WorkerWatcher:
    """The watcher of one worker: passes on its lines, and shows its progress beside that of the others."""

    name: str
    states: dict[str, str]
    watcher: Watcher

    def say(self, line: str) -> None:
        if line != "begins":
            self.watcher.say(line)

    def warn(self, line: str) -> None:
        self.watcher.warn(line)

    def carry_on(self) -> None:
        self.watcher.carry_on()

    def progress(self, work: str, state: str, fraction: float | None) -> None:
        self.states[self.name] = f"{work}: {state}"
        self.watcher.progress(_NAME, " | ".join(self.states.values()), None)
