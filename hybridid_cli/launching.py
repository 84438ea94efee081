"""A sweep's jobs through a launcher of Hydra's: this machine's processes, joblib, Slurm."""

from __future__ import annotations

import multiprocessing
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from hydra._internal.core_plugins.basic_launcher import BasicLauncher
from hydra.core.utils import JobReturn, JobStatus

from pipelines.shared.errors import ConfigError
from pipelines.shared.pool import core_count
from pipelines.shared.storage import json_text, read_json
from pipelines.shared.tree import write_text
from pipelines.shared.watch import Watcher
from pipelines.sweep.crew import Crew, Ended, Here, died, log_work
from pipelines.sweep.point import spelt
from pipelines.sweep.work import Failures, Work, said

BEGUN, OUTCOME = ".begun", ".outcome"


def crew_of(launcher: Any, words: Sequence[str], folder: Path, processes: int | None) -> Crew:
    """Who does the jobs: processes of our own for the basic launcher, which would do one after the other.

    ``words`` are overrides with which a job's own config can be composed.
    """
    if isinstance(launcher, BasicLauncher):
        return Here(processes or core_count())
    cores = None
    if type(launcher).__name__ == "JoblibLauncher":
        given = int(launcher.joblib.get("n_jobs") or -1)
        cores = given if given > 0 else core_count()
    return Launched(launcher, tuple(words), folder / "jobs", cores)


@dataclass
class Launched:
    """Jobs as files in ``folder``, each named to a process that the launcher starts."""

    launcher: Any
    words: tuple[str, ...]
    folder: Path
    cores: int | None
    _launched: int = field(default=0, init=False)

    def carry_out(self, works: Sequence[Work], watcher: Watcher, ended: Ended) -> Failures:
        self.folder.mkdir(parents=True, exist_ok=True)
        left = {self._written(work): work for work in works}
        paths = dict(left)
        troubles: dict[Path, str] = {}
        while left:
            before = len(left)
            lost, broke = self._launch(left, watcher)
            troubles |= lost
            # a broken pool takes jobs with it that had not begun: they are launched again. What the launcher
            # itself says is lost, somebody cancelled
            left = {path: work for path, work in left.items() if broke and not _marked(path, BEGUN)}
            if len(left) == before:
                break
        failures: dict[str, str] = {}
        for path, work in paths.items():
            failures |= _outcome(work, path, troubles.get(path, ""))
        return failures

    def _written(self, work: Work) -> Path:
        path = self.folder / f"{self._launched}-{work.points[0].key}{'-gray' * work.gray}.json"
        for old in (path.with_suffix(BEGUN), path.with_suffix(OUTCOME)):
            old.unlink(missing_ok=True)
        write_text(path, json_text(work.plain()))
        return path.resolve()

    def _launch(self, works: Mapping[Path, Work], watcher: Watcher) -> tuple[dict[Path, str], bool]:
        """Launch jobs and wait for all; what the launcher says of those it lost, and whether it broke."""
        own = f"hydra.sweep.dir={self.folder}"  # a job composes its config anew, from words
        jobs = [[*self.words, *_coordinates(work), own, f"sweep.job={path}"] for path, work in works.items()]
        number = self._launched
        self._launched += len(jobs)
        try:
            returns = self.launcher.launch(jobs, initial_job_idx=number)
        except ConfigError:
            raise
        except Exception as error:
            watcher.carry_on()
            return dict.fromkeys(works, said(error)), True
        lost = {path: given for path, given in zip(works, returns, strict=True) if _failed(given)}
        return {path: said(given._return_value) for path, given in lost.items()}, False


def _coordinates(work: Work) -> list[str]:
    """Where the job's first point lies, as overrides; a key may be one that the config lacks."""
    at = work.points[0].at.items()
    return [f"{'++' if '.' in key else ''}{key}={spelt(value)}" for key, value in at]


def _failed(given: JobReturn) -> bool:
    return given.status == JobStatus.FAILED


def _marked(path: Path, mark: str) -> bool:
    return path.with_suffix(mark).exists()


def _outcome(work: Work, path: Path, trouble: str) -> Failures:
    """Why points of a job have no result: as it said itself, or that it ended without a word."""
    if _marked(path, OUTCOME):
        return dict(read_json(path.with_suffix(OUTCOME)))
    reason = trouble or "without a word"
    if not _marked(path, BEGUN):
        reason = f"it never began; {reason}"
    return {point.key: died(work, reason) for point in work.points}


def job(path: Path, watcher: Watcher) -> None:
    """One job, in the process that a launcher started: done in a child, so that its end is heard of."""
    # joblib's workers have a start method of their own, which their children would not find
    multiprocessing.set_start_method("spawn", force=True)
    work = Work.of(read_json(path))
    write_text(path.with_suffix(BEGUN), "")
    failures = Here(1).carry_out([work], watcher, lambda done, lost: log_work(done, lost, watcher))
    write_text(path.with_suffix(OUTCOME), json_text(failures))
