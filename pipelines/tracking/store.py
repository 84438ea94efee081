"""The store of runs: the sqlite file beside the run trees, made by whoever comes first, or a server."""

from __future__ import annotations

import functools
import logging
import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from filelock import FileLock

from pipelines.shared.config import Settings
from pipelines.shared.held_back import held_back
from pipelines.shared.secrets import noted, with_password
from pipelines.tracking import patience

if TYPE_CHECKING:
    from mlflow.tracking import MlflowClient

STORE = "mlflow.db"
_SENDS_NOTHING = {"MLFLOW_DISABLE_TELEMETRY": "true", "DO_NOT_TRACK": "true"}
"""MLflow looks for these when it is imported, and again before it would send its maker anything."""
_SILENT = {"MLFLOW_SUPPRESS_PRINTING_URL_TO_STDOUT": "true"}  # stdout is for results


def tracking_uri(settings: Settings) -> str:
    """``mlflow.tracking_uri`` without its password, else the sqlite file beside the run trees."""
    given = settings.mlflow.tracking_uri
    return noted(given) if given else _address(store_folder(settings) / STORE)


def _address(store: Path) -> str:
    return f"sqlite:///{store}"


def store_folder(settings: Settings) -> Path:
    """``paths.outputs``."""
    return settings.outputs.resolve()


def client(settings: Settings, uri: str | None = None) -> MlflowClient:
    """A client of the store (at ``uri``, if given), which exists from then on."""
    set_environment()
    with alone(settings):
        own = store_folder(settings) / STORE
        at = uri or tracking_uri(settings)
        if at == _address(own) and not own.exists():
            _make(own)
        return _client(at, os.getpid())


def set_environment() -> None:
    """Set the environment variables that MLflow reads when it is imported."""
    os.environ.update(_SENDS_NOTHING)
    for name, value in (_SILENT | patience.REQUESTS).items():
        os.environ.setdefault(name, value)


def _make(store: Path) -> None:
    """Create the sqlite file in one step. MLflow can never use a file whose creation was interrupted."""
    new = store.with_name(f".{store.name}-new")
    for left in store.parent.glob(f"{new.name}*"):
        left.unlink()
    _client(_address(new), os.getpid())
    new.replace(store)


@functools.lru_cache
def _client(uri: str, process: int) -> MlflowClient:
    """A client, created once in each ``process``: forked processes must not share a connection."""
    from mlflow.tracking import MlflowClient

    # what they log as an error, with a traceback, they also raise: it is told in one line
    for name in ("mlflow", "alembic", "urllib3"):
        logging.getLogger(name).setLevel(logging.CRITICAL)
    with held_back():  # it makes the tables: cut off there, it reports a broken transaction instead
        return MlflowClient(tracking_uri=with_password(uri))


@contextmanager
def alone(settings: Settings) -> Iterator[None]:
    """Lock the store for this process, so that no other process finds its database locked."""
    folder = store_folder(settings)
    folder.mkdir(parents=True, exist_ok=True)
    with FileLock(str(folder / ".mlflow.lock"), timeout=patience.QUEUE, is_singleton=True):
        yield


def is_remote(uri: str) -> bool:
    """Whether a server keeps the store, and not a file."""
    return uri.startswith("http")


def answers(uri: str) -> bool:
    """Whether the server at ``uri`` answers at all; always true for a file."""
    if not is_remote(uri):
        return True
    import requests

    try:
        requests.get(uri, timeout=patience.ANSWER)
    except requests.RequestException:
        return False
    return True


def experiment_id(store: MlflowClient, settings: Settings, name: str, remote: bool) -> str:
    """The experiment ``name``, made if there is none; a server decides itself where its artifacts lie."""
    with alone(settings):
        found = store.get_experiment_by_name(name)
        if found is not None:
            return str(found.experiment_id)
        artifacts = None if remote else (store_folder(settings) / "mlflow-artifacts" / name).as_uri()
        return str(store.create_experiment(name, artifact_location=artifacts))
