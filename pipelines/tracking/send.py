"""Sends a note to MLflow. Sent twice, or again after it was cut off, it still makes one run."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, nullcontext
from itertools import islice
from typing import TYPE_CHECKING, TypeVar

from pipelines.shared.config import Settings
from pipelines.shared.held_back import held_back
from pipelines.tracking.begun import marked
from pipelines.tracking.note import KEY, Artifact, Note, Status
from pipelines.tracking.patience import clock
from pipelines.tracking.store import alone, client, experiment_id, is_remote, tracking_uri

if TYPE_CHECKING:
    from mlflow.entities import Run
    from mlflow.tracking import MlflowClient

T = TypeVar("T")
LOGGED = "hybridid.logged"
"""The tag that is set last: the digest of the note that fills the run."""
_METRICS_A_CALL = 1000
_PARAMETERS_A_CALL = 100
_PARENT = "mlflow.parentRunId"


def send(note: Note, settings: Settings, patience: float | None = None) -> None:
    """Fill the note's run, made if there is none. What the run holds from a later note stays.

    A server may take ``patience`` seconds (None: any time).

    Raises:
        Slow: if it takes longer.
        Exception: whatever MLflow says is wrong.
    """
    uri = note.uri or tracking_uri(settings)
    remote = is_remote(uri)
    in_time = clock(patience if remote else None)
    store = client(settings, uri)
    with _writing(settings, remote), marked(note.key, note.experiment, settings, uri):
        experiment = experiment_id(store, settings, note.experiment, remote)
        in_time()
        with _killed_if_interrupted(store, experiment, note.key):
            run = _run_of(store, settings, experiment, note.key, note.name, note.began)
            if run.data.tags.get(LOGGED) != note.digest:
                _fill(store, settings, experiment, run, note, in_time)


@contextmanager
def _writing(settings: Settings, remote: bool) -> Iterator[None]:
    """Lock the sqlite file, which allows one writer at a time, and delay signals. A server needs neither.

    A signal that interrupts a write leaves the file locked, and then the run cannot be ended.
    """
    with nullcontext() if remote else alone(settings), nullcontext() if remote else held_back():
        yield


@contextmanager
def _killed_if_interrupted(store: MlflowClient, experiment: str, key: str) -> Iterator[None]:
    """End the run of ``key``, if it exists, when a signal ends the command: no later command would end it."""
    try:
        yield
    except Exception:
        raise  # it is kept, and filled later
    except BaseException as error:
        _end(store, experiment, key, "KILLED", f"interrupted: {type(error).__name__}")
        raise


def end(key: str, experiment: str, settings: Settings, status: Status, reason: str) -> None:
    """End the run of ``key`` in the store of ``settings``, if it is there and goes on.

    Raises:
        Exception: whatever MLflow says is wrong.
    """
    store = client(settings)
    with _writing(settings, is_remote(tracking_uri(settings))):
        found = store.get_experiment_by_name(experiment)
        if found is not None:
            _end(store, found.experiment_id, key, status, reason)


def _end(store: MlflowClient, experiment: str, key: str, status: Status, reason: str) -> None:
    which = f"tags.`{KEY}` = '{key}' and attributes.status = 'RUNNING'"
    for run in store.search_runs([experiment], which):
        store.set_tag(run.info.run_id, "error", reason)
        store.set_terminated(run.info.run_id, status)


def _run_of(store: MlflowClient, settings: Settings, experiment: str, key: str, name: str, began: int) -> Run:
    """The run of ``key``, created if it does not exist. A lock keeps two processes from creating it twice."""
    with alone(settings):
        found = store.search_runs([experiment], f"tags.`{KEY}` = '{key}'", max_results=1)
        if found:
            return found[0]
        return store.create_run(experiment, start_time=began, run_name=name, tags={KEY: key})


def _fill(
    store: MlflowClient,
    settings: Settings,
    experiment: str,
    run: Run,
    note: Note,
    in_time: Callable[[], None],
) -> None:
    from mlflow.entities import Metric, Param, RunTag

    identity, late = run.info.run_id, _is_late(note, run)
    tags = {**note.tags, "mlflow.runName": note.name, **_parent_of(note, store, settings, experiment)}
    if late:
        tags = {name: tag for name, tag in tags.items() if name not in (*run.data.tags, "error")}
    for gone in set() if late else {"error"} & (set(run.data.tags) - set(tags)):
        store.delete_tag(identity, gone)
    store.log_batch(identity, tags=[RunTag(k, str(v)) for k, v in tags.items()])
    # a parameter cannot be changed: an earlier attempt's stays
    params = [Param(k, v) for k, v in note.params.items() if k not in run.data.params]
    when = note.began if note.ended is None else note.ended  # the same time again is the same point again
    held = run.data.metrics if late else ()
    points = [Metric(m.name, m.value, when, m.step) for m in note.metrics if m.name not in held]
    for some in _parts(params, _PARAMETERS_A_CALL):
        in_time()
        store.log_batch(identity, params=some)
    for part in _parts(points, _METRICS_A_CALL):
        in_time()
        store.log_batch(identity, metrics=part)
    for artifact in () if late else note.artifacts:
        _upload(store, identity, artifact, in_time)
    in_time()
    if late:
        return
    if note.ended is None:
        store.update_run(identity, status=note.status)
    else:
        store.set_terminated(identity, note.status, note.ended)
    store.set_tag(identity, LOGGED, note.digest)


def _parent_of(note: Note, store: MlflowClient, settings: Settings, experiment: str) -> dict[str, str]:
    """The tag that names the parent's run; one that is still waiting itself is filled when it comes."""
    if note.parent is None:
        return {}
    parent = _run_of(store, settings, experiment, note.parent, "sweep", note.began)
    return {_PARENT: parent.info.run_id}


def _is_late(note: Note, run: Run) -> bool:
    """Whether the store already has a later result of the same run, made while this note waited."""
    ended = run.info.end_time
    said = note.began if note.ended is None else note.ended
    return run.info.status in ("FINISHED", "FAILED") and ended is not None and ended > said


def _parts(items: Sequence[T], size: int) -> Iterator[list[T]]:
    rest = iter(items)
    while part := list(islice(rest, size)):
        yield part


def _upload(store: MlflowClient, identity: str, artifact: Artifact, in_time: Callable[[], None]) -> None:
    """Upload file by file, and check the time limit before each file of a folder."""
    if artifact.source.is_file():
        store.log_artifact(identity, str(artifact.source), artifact.into or None)
        return
    for path in sorted(p for p in artifact.source.rglob("*") if p.is_file()):
        in_time()
        below = path.parent.relative_to(artifact.source).as_posix()
        into = "/".join(part for part in (artifact.into, below) if part not in ("", "."))
        store.log_artifact(identity, str(path), into or None)
