"""MLflow: each command is a run, written after its results are safe. Nothing here can lose a result.

A sweep is a parent run with a nested run for each of its points. What the store does not take, since it is
down, slow or broken, is kept in a file (``waiting``), and ``hybridid log`` sends it later.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import Any
from uuid import uuid4

from filelock import Timeout

from pipelines.shared.config import Settings
from pipelines.shared.errors import ConfigError
from pipelines.shared.stage import Outcome
from pipelines.shared.watch import Watcher
from pipelines.tracking.facts import about, artifacts_of, finite, metrics_of_run, parameters, tags_of
from pipelines.tracking.note import Artifact, Note, Status, short
from pipelines.tracking.patience import Slow, pause, paused
from pipelines.tracking.send import send
from pipelines.tracking.store import client, tracking_uri
from pipelines.tracking.waiting import SILENT, keep, reason, waiting

__all__ = ["Point", "Run", "client", "close_parent", "log_point", "open_parent", "tracked", "tracking_uri"]

_warned: set[str] = set()


class Run:
    """One command to be logged; ``finish`` says what it did."""

    def __init__(self, settings: Settings, command: str) -> None:
        self.settings, self.command = settings, command
        self.began = time.time()
        self.outcome: Outcome | None = None

    def finish(self, outcome: Outcome) -> None:
        """Log the outcome when the run ends."""
        self.outcome = outcome


@dataclass(frozen=True)
class Point:
    """A finished point of a sweep. The same ``key`` again is the same run again.

    ``began`` is in s since 1970; ``error`` says why it failed; ``artifacts`` are files and folders.
    """

    key: str
    name: str
    params: Mapping[str, object]
    metrics: Mapping[str, float]
    began: float
    seconds: float
    tags: Mapping[str, str] = field(default_factory=dict)
    error: str = ""
    artifacts: Sequence[Path] = ()


@contextmanager
def tracked(
    settings: Settings, command: str, watcher: Watcher, parent: str | None = None, key: str | None = None
) -> Iterator[Run]:
    """Log what happens inside as one run; also when it fails, but not when it is interrupted.

    A wrong request (``ConfigError``) never began and leaves no run. ``parent`` is the key of the sweep it
    belongs to; ``key`` its own, if the same run again is not to be a second.
    """
    run = Run(settings, command)
    key = key or uuid4().hex
    try:
        yield run
    except ConfigError:
        raise
    except Exception as error:
        _log(settings, partial(_note_of_run, run, key, parent, error), watcher)
        raise
    _log(settings, partial(_note_of_run, run, key, parent, None), watcher)


def open_parent(settings: Settings, name: str, key: str, tags: Mapping[str, str], watcher: Watcher) -> None:
    """Begin the run of a sweep; it is the same again for the same ``key``."""

    def note() -> Note:
        known = {**about(settings, name), **tags}
        return _note(settings, key, name, time.time(), tags=known, params=parameters(settings))

    _log(settings, note, watcher)


def log_point(settings: Settings, point: Point, parent: str, watcher: Watcher) -> None:
    """Log a point as a nested run of the sweep ``parent``; at once if it is there already."""

    def note() -> Note:
        failure = {"error": short(point.error)} if point.error else {}
        return _note(
            settings,
            point.key,
            point.name,
            point.began,
            point.began + point.seconds,
            "FAILED" if point.error else "FINISHED",
            parent=parent,
            tags={**about(settings, point.name), **point.tags, **failure},
            params={name: short(value) for name, value in point.params.items()},
            metrics=finite(point.metrics),
            artifacts=_files(point.artifacts),
        )

    _log(settings, note, watcher)


def close_parent(
    settings: Settings,
    name: str,
    key: str,
    watcher: Watcher,
    failed: bool = False,
    metrics: Mapping[str, float] | None = None,
    artifacts: Sequence[Path] = (),
) -> None:
    """End the run of a sweep, and say how many of its runs wait to be sent."""

    def note() -> Note:
        return _note(
            settings,
            key,
            name,
            now,
            now,
            "FAILED" if failed else "FINISHED",
            metrics=finite(metrics or {}),
            artifacts=_files(artifacts),
        )

    now = time.time()
    _log(settings, note, watcher)
    kept = {one.key for _, one in waiting(settings) if key in (one.key, one.parent)}
    if kept:
        watcher.warn(f"{len(kept)} runs of this sweep wait to be logged to MLflow: {_later(settings)}")


def _log(settings: Settings, note_of: Callable[[], Note], watcher: Watcher) -> None:
    """Send a note or, failing that, keep it: whatever is wrong with the store, the results stand."""
    if not settings.mlflow.enabled:
        return
    try:
        note = note_of()
        trouble = _sent(note, settings)
        if trouble:
            keep(note, settings)
            _warn_once(settings, watcher, trouble)
    except Exception as error:
        line = short(f"{type(error).__name__}: {error}")[:200]
        watcher.warn(f"not logged to MLflow ({line}); the results are complete without it")


def _sent(note: Note, settings: Settings) -> str:
    """Send it; why it could not be, if so. A store that kept us waiting a moment ago is not asked again."""
    uri = tracking_uri(settings)
    if paused(uri):
        return "it did not answer in time, less than a minute ago"
    try:
        send(note, settings, settings.mlflow.patience)
    except Exception as error:
        trouble = reason(error, uri)
        if trouble == SILENT or isinstance(error, (Slow, Timeout)):
            pause(uri)
        return trouble
    return ""


def _warn_once(settings: Settings, watcher: Watcher, trouble: str) -> None:
    uri = tracking_uri(settings)
    if uri not in _warned:
        _warned.add(uri)
        watcher.warn(
            f"not logged to MLflow at {uri} ({trouble}); the results are complete, and the run is kept: "
            + _later(settings)
        )


def _later(settings: Settings) -> str:
    outputs = str(settings.outputs)
    where = "" if outputs == "outputs" else f" paths.outputs={outputs}"
    return f"hybridid log{where} sends what waits in {outputs}/mlflow-waiting"


def _note_of_run(run: Run, key: str, parent: str | None, error: Exception | None) -> Note:
    failure = {"error": short(f"{type(error).__name__}: {error}")} if error else {}
    outcome = run.outcome
    return _note(
        run.settings,
        key,
        run.command,
        run.began,
        time.time(),
        "FAILED" if error else "FINISHED",
        parent=parent,
        tags={**about(run.settings, run.command), **(tags_of(outcome) if outcome else {}), **failure},
        params=parameters(run.settings),
        metrics=metrics_of_run(outcome) if outcome else (),
        artifacts=artifacts_of(outcome) if outcome else (),
    )


def _files(paths: Sequence[Path]) -> tuple[Artifact, ...]:
    """A folder keeps its name."""
    return tuple(Artifact(path, path.name if path.is_dir() else "") for path in paths)


def _note(
    settings: Settings,
    key: str,
    name: str,
    began: float,
    ended: float | None = None,
    status: Status = "RUNNING",
    **rest: Any,
) -> Note:
    """A note for the store and experiment of ``settings``; times in s."""
    return Note(
        key=key,
        name=name,
        experiment=settings.mlflow.experiment or settings.case,
        uri=settings.mlflow.tracking_uri,
        began=round(began * 1000),
        ended=None if ended is None else round(ended * 1000),
        status=status,
        **rest,
    )
