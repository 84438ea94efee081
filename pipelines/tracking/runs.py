"""MLflow: each command is a run, written after its results are safe. Nothing here can lose a result.

A sweep is a parent run with a nested run for each of its points. What the store does not take, since it is
down, slow or broken, is kept in a file (``waiting``), and ``hybridid log`` sends it later.
"""

from __future__ import annotations

import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from uuid import uuid4

from pipelines.shared.config import Settings
from pipelines.shared.errors import ConfigError
from pipelines.shared.stage import Outcome
from pipelines.shared.watch import Watcher
from pipelines.tracking.facts import about, artifacts_of, finite, metrics_of_run, parameters, tags_of
from pipelines.tracking.log import files, log, note
from pipelines.tracking.note import Note, raised, short
from pipelines.tracking.store import client, tracking_uri

__all__ = ["Point", "Run", "client", "log_point", "tracked", "tracking_uri"]


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
def tracked(settings: Settings, command: str, watcher: Watcher) -> Iterator[Run]:
    """Log what happens inside as one run; also when it fails, but not when it is interrupted.

    A wrong request (``ConfigError``) never began and leaves no run.
    """
    run = Run(settings, command)
    try:
        yield run
    except ConfigError:
        raise
    except Exception as error:
        log(settings, partial(_note_of_run, run, error), watcher)
        raise
    log(settings, partial(_note_of_run, run, None), watcher)


def log_point(settings: Settings, point: Point, parent: str, watcher: Watcher) -> None:
    """Log a point as a nested run of the sweep ``parent``; at once if it is there already."""

    def logged() -> Note:
        failure = {"error": short(point.error)} if point.error else {}
        return note(
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
            artifacts=files(point.artifacts),
        )

    log(settings, logged, watcher)


def _note_of_run(run: Run, error: Exception | None) -> Note:
    failure = {"error": raised(error)} if error else {}
    outcome = run.outcome
    return note(
        run.settings,
        uuid4().hex,
        run.command,
        run.began,
        time.time(),
        "FAILED" if error else "FINISHED",
        tags={**about(run.settings, run.command), **(tags_of(outcome) if outcome else {}), **failure},
        params=parameters(run.settings),
        metrics=metrics_of_run(outcome) if outcome else (),
        artifacts=artifacts_of(outcome) if outcome else (),
    )
