"""Runs a sweep's jobs through one of Hydra's launchers: processes of this machine, joblib or Slurm."""

from __future__ import annotations

import multiprocessing
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from hydra._internal.core_plugins.basic_launcher import BasicLauncher
from hydra.core.utils import JobStatus

from pipelines.shared.config import Settings
from pipelines.shared.errors import ConfigError, LostJob
from pipelines.shared.pool import core_count
from pipelines.shared.storage import json_text, read_json
from pipelines.shared.tree import write_text
from pipelines.shared.trust import admit, paths_in
from pipelines.shared.watch import Watcher
from pipelines.sweep.job_runner import ONCE_MORE, JobRunner, LocalProcesses, OnJobEnd, log_job, lost_reason
from pipelines.sweep.point import spelt
from pipelines.sweep.work import Failures, SweepJob
from pipelines.tracking.note import one_line

BEGUN, OUTCOME = ".begun", ".outcome"


def runner_of(
    launcher: Any,
    words: Sequence[str],
    folder: Path,
    processes: int | None,
    added: frozenset[str] = frozenset(),
) -> JobRunner:
    """The runner of the jobs. The basic launcher runs one job at a time, so local processes replace it.

    ``words`` are the overrides from which each job composes its config. ``added`` are the swept keys and
    groups that the config lacks.
    """
    if isinstance(launcher, BasicLauncher):
        return LocalProcesses(processes or core_count())
    cores = None
    if type(launcher).__name__ == "JoblibLauncher":
        given = int(launcher.joblib.get("n_jobs") or -1)
        cores = given if given > 0 else core_count()
    return LauncherProcesses(launcher, tuple(words), folder / "jobs", cores, added)


@dataclass
class LauncherProcesses:
    """Writes jobs as files into ``folder``; the launcher starts a process for each."""

    launcher: Any
    words: tuple[str, ...]
    folder: Path
    cores: int | None
    added: frozenset[str] = frozenset()
    _launched: int = field(default=0, init=False)

    def carry_out(self, sweep_jobs: Sequence[SweepJob], watcher: Watcher, ended: OnJobEnd) -> Failures:
        """Run all jobs. A broken pool is started again for the jobs that had not begun.

        A trace that was lost by chance is launched once more, since it continues where it stopped.
        """
        self.folder.mkdir(parents=True, exist_ok=True)
        left = {self._written(sweep_job): sweep_job for sweep_job in sweep_jobs}
        paths = dict(left)
        troubles: dict[Path, str] = {}
        once_more: set[Path] = set()
        while left:
            before = len(left)
            lost, broke = self._launch(left, watcher)
            troubles |= {path: one_line(error) for path, error in lost.items()}
            again = {path for path in lost if _again(left[path], lost[path])} - once_more
            once_more |= again
            for path in again:
                watcher.say(f"{left[path].name}: {troubles[path]}; {ONCE_MORE}")
            # a broken pool also loses jobs that had not begun: they are launched again. A job that the
            # launcher itself reports as failed was cancelled: it is not
            left = {
                path: sweep_job
                for path, sweep_job in left.items()
                if path in again or (broke and not _marked(path, BEGUN))
            }
            if len(left) == before and not again:
                break
        failures: dict[str, str] = {}
        for path, sweep_job in paths.items():
            failures |= _outcome(sweep_job, path, troubles.get(path, ""))
        return failures

    def _written(self, sweep_job: SweepJob) -> Path:
        path = self.folder / f"{self._launched}-{sweep_job.points[0].key}{'-gray' * sweep_job.gray}.json"
        for old in (path.with_suffix(BEGUN), path.with_suffix(OUTCOME)):
            old.unlink(missing_ok=True)
        write_text(path, json_text(sweep_job.plain()), mode=0o600)
        return path.resolve()

    def _launch(
        self, sweep_jobs: Mapping[Path, SweepJob], watcher: Watcher
    ) -> tuple[dict[Path, Exception], bool]:
        """Launch jobs and wait for all; returns why jobs failed, and whether the launcher itself failed."""
        own = f"hydra.sweep.dir={self.folder}"  # a job composes its config anew, from words
        jobs = [
            [*self.words, *_coordinates(sweep_job, self.added), own, f"sweep.job={path}"]
            for path, sweep_job in sweep_jobs.items()
        ]
        number = self._launched
        self._launched += len(jobs)
        try:
            returns = self.launcher.launch(jobs, initial_job_idx=number)
        except ConfigError:
            raise
        except Exception as error:
            watcher.carry_on()
            return dict.fromkeys(sweep_jobs, error), True
        lost = {
            path: given
            for path, given in zip(sweep_jobs, returns, strict=True)
            if given.status == JobStatus.FAILED
        }
        return {path: given._return_value for path, given in lost.items()}, False


def _coordinates(sweep_job: SweepJob, added: frozenset[str]) -> list[str]:
    """The coordinates of the job's first point as overrides.

    ``++`` adds a key, and ``+`` a group, that the config lacks.
    """
    at = sweep_job.points[0].at.items()
    return [f"{'++' if '.' in key else '+' * (key in added)}{key}={spelt(value)}" for key, value in at]


def _again(sweep_job: SweepJob, error: Exception) -> bool:
    """Whether a lost job is worth another launch."""
    return isinstance(error, LostJob) and error.by_chance and sweep_job.goes_on


def _marked(path: Path, mark: str) -> bool:
    return path.with_suffix(mark).exists()


def _outcome(sweep_job: SweepJob, path: Path, trouble: str) -> Failures:
    """Why points of a job have no result: from its outcome file, or because it ended without one."""
    if _marked(path, OUTCOME):
        return dict(read_json(path.with_suffix(OUTCOME)))
    reason = trouble or "its process ended without a result"
    if not _marked(path, BEGUN):
        reason = f"it never began; {reason}"
    return {point.key: lost_reason(sweep_job, reason) for point in sweep_job.points}


def job(path: Path, settings: Settings, watcher: Watcher) -> None:
    """Run one job in the process that a launcher started; a child does the work, so a crash is noticed.

    Code that the job's file names runs only if it is that of the command's own ``settings``, or trusted.
    """
    sweep_job = SweepJob.of(read_json(path))
    for point in sweep_job.points:
        admit(f"sweep.job is {path}: it", paths_in(point.settings.config), (), paths_in(settings.config))
    # joblib's workers use a start method that is not available in their children
    multiprocessing.set_start_method("spawn", force=True)
    write_text(path.with_suffix(BEGUN), "")
    failures = LocalProcesses(1).carry_out(
        [sweep_job], watcher, lambda done, lost: log_job(done, lost, watcher)
    )
    write_text(path.with_suffix(OUTCOME), json_text(failures))
