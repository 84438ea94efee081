"""Sends the note of a run or keeps it: whatever is wrong with the store, the results stand."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from filelock import Timeout

from pipelines.shared.config import Settings
from pipelines.shared.secrets import credentials
from pipelines.shared.watch import Watcher
from pipelines.tracking import ahead
from pipelines.tracking.abandoned import end_abandoned
from pipelines.tracking.begun import lift_left
from pipelines.tracking.note import Artifact, Note, Status, raised
from pipelines.tracking.patience import Slow, pause, paused
from pipelines.tracking.send import send
from pipelines.tracking.store import tracking_uri
from pipelines.tracking.waiting import SILENT, keep, reason

_warned: set[str] = set()
_looked: set[str] = set()


def log(settings: Settings, note_of: Callable[[], Note], watcher: Watcher) -> bool:
    """Send a note or, failing that, keep it; False if neither can be done, as on a full disk."""
    if not settings.mlflow.enabled:
        return True
    try:
        note = note_of()
        trouble = _sent(note, settings)
        if trouble:
            keep(note, settings)
            lift_left(note.key, settings)
            _warn_once(settings, watcher, trouble)
        else:
            _look_once(settings, watcher)
    except Exception as error:
        watcher.warn(f"not logged to MLflow ({raised(error, 200)}); the results are complete without it")
        return False
    return True


def note(
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
        experiment=experiment_of(settings),
        uri=tracking_uri(settings) if settings.mlflow.tracking_uri else None,
        began=round(began * 1000),
        ended=None if ended is None else round(ended * 1000),
        status=status,
        **rest,
    )


def experiment_of(settings: Settings) -> str:
    """``mlflow.experiment``, else the case."""
    return settings.mlflow.experiment or settings.case


def files(paths: Sequence[Path]) -> tuple[Artifact, ...]:
    """A folder keeps its name."""
    return tuple(Artifact(path, path.name if path.is_dir() else "") for path in paths)


def later(settings: Settings) -> str:
    """What sends the runs that wait, and the password that it needs."""
    outputs = str(settings.outputs)
    where = "" if outputs == "outputs" else f" paths.outputs={outputs}"
    needed = credentials(tracking_uri(settings))
    password = f", if {' and '.join(needed)} are set as now" if needed else ""
    return f"hybridid log{where} sends what waits in {outputs}/mlflow-waiting{password}"


def _sent(given: Note, settings: Settings) -> str:
    """Send it; why it could not be, if so. A store that kept us waiting a moment ago is not asked again."""
    uri = tracking_uri(settings)
    if paused(uri):
        return "it did not answer in time, less than a minute ago"
    if ahead.sends(settings):
        return ahead.sent_beside(given, settings)
    try:
        send(given, settings, settings.mlflow.patience)
    except Exception as error:
        trouble = reason(error, uri)
        if trouble == SILENT or isinstance(error, (Slow, Timeout)):
            pause(uri)
        return trouble
    return ""


def _look_once(settings: Settings, watcher: Watcher) -> None:
    """End what killed processes left: once in each process, and only where the store answers."""
    uri = tracking_uri(settings)
    if uri not in _looked:
        _looked.add(uri)
        if trouble := end_abandoned(settings):
            watcher.warn(f"runs of killed commands are still RUNNING in MLflow: {trouble}")


def _warn_once(settings: Settings, watcher: Watcher, trouble: str) -> None:
    uri = tracking_uri(settings)
    if uri not in _warned:
        _warned.add(uri)
        watcher.warn(
            f"not logged to MLflow at {uri} ({trouble}); the results are complete, and the run is kept: "
            + later(settings)
        )
