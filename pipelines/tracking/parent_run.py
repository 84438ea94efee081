"""The run of a sweep or a search. It stays open while its points are logged below it, and it always ends."""

from __future__ import annotations

import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path

from pipelines.shared.config import Settings
from pipelines.shared.watch import Watcher
from pipelines.tracking.begun import Mark
from pipelines.tracking.facts import about, finite, parameters
from pipelines.tracking.log import experiment_of, files, later, log, note
from pipelines.tracking.note import Note, Status, raised
from pipelines.tracking.waiting import waiting


class ParentRun:
    """One sweep or search to be logged. It is the same run again for the same ``key``."""

    def __init__(self, settings: Settings, name: str, key: str, watcher: Watcher) -> None:
        self.settings, self.name, self.key = settings, name, key
        self._watcher = watcher
        self._mark: Mark | None = None

    def open(self, tags: Mapping[str, str]) -> None:
        """Begin the run."""

        def opened() -> Note:
            self._mark = Mark(self.key, experiment_of(self.settings), self.settings)
            known = {**about(self.settings, self.name), **tags}
            params = parameters(self.settings)
            return note(self.settings, self.key, self.name, time.time(), tags=known, params=params)

        log(self.settings, opened, self._watcher)

    def close(
        self,
        failed: bool = False,
        metrics: Mapping[str, float] | None = None,
        artifacts: Sequence[Path] = (),
    ) -> None:
        """End the run, and say how many of its runs wait to be sent."""
        status: Status = "FAILED" if failed else "FINISHED"
        self._end(status, metrics=finite(metrics or {}), artifacts=files(artifacts))
        kept = {one.key for _, one in waiting(self.settings) if self.key in (one.key, one.parent)}
        if kept:
            line = f"{len(kept)} runs of this sweep wait to be logged to MLflow: {later(self.settings)}"
            self._watcher.warn(line)

    def break_off(self, error: BaseException) -> None:
        """End the run, if it has begun and not ended, with what was raised: ``KILLED`` by a signal, else
        ``FAILED``."""
        if self._mark is not None:
            status: Status = "FAILED" if isinstance(error, Exception) else "KILLED"
            self._end(status, tags={"error": raised(error)})

    def _end(self, status: Status, **known: object) -> None:
        now = time.time()
        ended = log(
            self.settings,
            lambda: note(self.settings, self.key, self.name, now, now, status, **known),
            self._watcher,
        )
        if self._mark is not None:
            if ended:
                self._mark.lift()
            else:
                self._mark.leave()
            self._mark = None


@contextmanager
def parent_run(settings: Settings, name: str, key: str, watcher: Watcher) -> Iterator[ParentRun]:
    """The run of a sweep or a search, to be opened and closed inside. What is raised ends it, too."""
    parent = ParentRun(settings, name, key, watcher)
    try:
        yield parent
    except BaseException as error:
        parent.break_off(error)
        raise
