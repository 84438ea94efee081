"""MLflow: each command is a run, written after its results are safe. Nothing here can lose a result.

The store is a sqlite file beside the run trees; whoever comes first makes it, under a lock.
"""

from __future__ import annotations

import logging
import os
import subprocess
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

from filelock import FileLock

from pipelines.config import Settings, flat
from pipelines.findings import cost_history, facts, metrics_of, provenance_of
from pipelines.stage import Outcome
from pipelines.watch import Watcher

if TYPE_CHECKING:
    from mlflow.tracking import MlflowClient

_LONGEST_PARAMETER = 6000
_BATCH = 1000
_PARAMETERS_A_CALL = 100


class Run:
    """One command to be logged; ``finish`` says what it did."""

    def __init__(self, settings: Settings, command: str) -> None:
        self.settings, self.command = settings, command
        self.began = time.time()
        self.outcome: Outcome | None = None

    def finish(self, outcome: Outcome) -> None:
        self.outcome = outcome


@contextmanager
def tracked(settings: Settings, command: str, watcher: Watcher) -> Iterator[Run]:
    """Log what happens inside as one run; also when it fails, but not when it is interrupted.

    A wrong request (``ConfigError``) never began and leaves no run.
    """
    from pipelines.errors import ConfigError

    run = Run(settings, command)
    try:
        yield run
    except ConfigError:
        raise
    except Exception as error:
        _log_safely(run, watcher, error)
        raise
    _log_safely(run, watcher, None)


def tracking_uri(settings: Settings) -> str:
    """``mlflow.tracking_uri``, else the sqlite file beside the run trees."""
    return str(settings.get("mlflow.tracking_uri") or f"sqlite:///{_store_folder(settings) / 'mlflow.db'}")


def client(settings: Settings) -> MlflowClient:
    """A client of the store, which exists from then on."""
    os.environ.setdefault("MLFLOW_DISABLE_TELEMETRY", "true")
    os.environ.setdefault("DO_NOT_TRACK", "true")
    from mlflow.tracking import MlflowClient

    for name in ("mlflow", "alembic"):
        logging.getLogger(name).setLevel(logging.WARNING)
    folder = _store_folder(settings)
    folder.mkdir(parents=True, exist_ok=True)
    with FileLock(str(folder / ".mlflow.lock")):
        return MlflowClient(tracking_uri=tracking_uri(settings))


def _store_folder(settings: Settings) -> Path:
    return Path(str(settings["paths.outputs"])).resolve()


def _log_safely(run: Run, watcher: Watcher, error: Exception | None) -> None:
    if not run.settings.get("mlflow.enabled", True):
        return
    try:
        _log(run, error)
    except Exception as trouble:  # whatever is wrong with the store, the results stand
        line = " ".join(str(trouble).split())[:200]
        watcher.warn(
            f"not logged to MLflow ({type(trouble).__name__}: {line}); the results are complete without it"
        )


def _log(run: Run, error: Exception | None) -> None:
    store = client(run.settings)
    experiment = _experiment(store, run.settings)
    created = store.create_run(
        experiment, start_time=round(run.began * 1000), run_name=run.command, tags=_tags(run, error)
    )
    identity = created.info.run_id
    _log_parameters(store, identity, run.settings)
    if run.outcome is not None:
        _log_outcome(store, identity, run.outcome)
    store.set_terminated(identity, "FAILED" if error else "FINISHED")


def _experiment(store: MlflowClient, settings: Settings) -> str:
    name = str(settings.get("mlflow.experiment") or settings.case)
    folder = _store_folder(settings)
    with FileLock(str(folder / ".mlflow.lock")):
        found = store.get_experiment_by_name(name)
        if found is not None:
            return str(found.experiment_id)
        artifacts = (
            None if settings.get("mlflow.tracking_uri") else (folder / "mlflow-artifacts" / name).as_uri()
        )
        return str(store.create_experiment(name, artifact_location=artifacts))


def _tags(run: Run, error: Exception | None) -> dict[str, Any]:
    tags = {"command": run.command, "case": run.settings.case, **_commit()}
    if run.outcome is not None:
        tags |= {
            "tree": str(run.outcome.tree.resolve()),
            "stages.ran": ", ".join(run.outcome.ran) or "none",
            "stages.reused": ", ".join(run.outcome.reused) or "none",
            "provenance": provenance_of(run.outcome.tree),
            **facts(run.outcome.tree),
        }
    if error is not None:
        tags["error"] = " ".join(f"{type(error).__name__}: {error}".split())[:_LONGEST_PARAMETER]
    return tags


def _log_parameters(store: MlflowClient, identity: str, settings: Settings) -> None:
    from mlflow.entities import Param

    parameters = [
        Param(k, str(v)[:_LONGEST_PARAMETER]) for k, v in flat(settings.config).items() if k != "case.source"
    ]
    for start in range(0, len(parameters), _PARAMETERS_A_CALL):
        store.log_batch(identity, params=parameters[start : start + _PARAMETERS_A_CALL])


def _log_outcome(store: MlflowClient, identity: str, outcome: Outcome) -> None:
    from mlflow.entities import Metric

    now = round(time.time() * 1000)
    points = [Metric(name, value, now, 0) for name, value in metrics_of(outcome.tree, outcome.stages).items()]
    if "fit" in outcome.stages:
        points += [Metric("cost", cost, now, step) for step, cost in enumerate(cost_history(outcome.tree))]
    for start in range(0, len(points), _BATCH):
        store.log_batch(identity, metrics=points[start : start + _BATCH])
    store.log_artifact(identity, str(outcome.tree / "config.yaml"))
    for stage in outcome.stages:
        if stage != "preprocess":  # records stay where they are: their digests are logged
            store.log_artifacts(identity, str(outcome.tree / stage), artifact_path=stage)


def _commit() -> dict[str, str]:
    """The commit of the checkout that hybridid runs from, if it is one."""
    home = Path(__file__).resolve().parents[1]
    try:
        if Path(_git(home, "rev-parse", "--show-toplevel")).resolve() != home:
            return {}  # installed somewhere inside another repository
        changed = bool(_git(home, "status", "--porcelain", "--untracked-files=no"))
        return {
            "mlflow.source.git.commit": _git(home, "rev-parse", "HEAD"),
            "git.changed": str(changed).lower(),
        }
    except (OSError, subprocess.SubprocessError):
        return {}


def _git(folder: Path, *words: str) -> str:
    said = subprocess.run(
        ["git", "-C", str(folder), *words], capture_output=True, text=True, check=True, timeout=5
    )
    return said.stdout.strip()
