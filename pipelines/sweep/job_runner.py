"""How the jobs of a sweep are run: by processes on this machine, or by a Hydra launcher."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Protocol

from pipelines.shared.board import Board
from pipelines.shared.pool import Lost, side_by_side
from pipelines.shared.watch import Watcher
from pipelines.sweep.log import log_points
from pipelines.sweep.work import Failures, SweepJob, carry_out

OnJobEnd = Callable[[SweepJob, Failures], None]
"""Called with a finished job and the failures of its points."""

ONCE_MORE = "it is started once more and continues where it stopped"
"""The message about a trace whose process was lost."""


class JobRunner(Protocol):
    """Runs the jobs of a sweep."""

    @property
    def cores(self) -> int | None:
        """The number of jobs that run at a time; None for no limit."""

    def carry_out(self, jobs: Sequence[SweepJob], watcher: Watcher, ended: OnJobEnd) -> Failures:
        """Run all jobs and return why points have no result. If a process is killed, the other jobs continue.

        ``ended`` is called for each finished job that is not logged yet.
        """


@dataclass(frozen=True)
class LocalProcesses:
    """Runs jobs in ``cores`` processes of one thread on this machine."""

    cores: int

    def carry_out(self, jobs: Sequence[SweepJob], watcher: Watcher, ended: OnJobEnd) -> Failures:
        """Run all jobs, ``cores`` at a time. A trace whose process is lost is started once more at the end,
        since it continues where it stopped."""
        names = {job.name: job for job in jobs}
        board = Board("sweep", list(names), watcher)
        began: dict[str, float] = {}
        failures: dict[str, str] = {}
        once_more = dict[str, SweepJob]()
        for left, again in ((names, False), (once_more, True)):
            for name, outcome in side_by_side(carry_out, left, self.cores, lambda n: _begun(began, n, board)):
                of_job = outcome
                if isinstance(of_job, Lost):
                    if names[name].goes_on and of_job.error is None and not again:
                        watcher.say(f"{name}: {of_job.reason}; {ONCE_MORE}")
                        once_more[name] = names[name]
                        continue
                    of_job = {p.key: lost_reason(names[name], of_job.reason) for p in names[name].points}
                failures |= of_job
                if of_job:
                    lost = "" if len(of_job) == 1 else f"{len(of_job)} points: "
                    board.failed(name, lost + next(iter(of_job.values())))
                else:
                    board.done(name, time.monotonic() - began[name])
                ended(names[name], of_job)
        return failures


def lost_reason(job: SweepJob, reason: str) -> str:
    """Why the points of a job without an outcome have no result."""
    return reason if len(job.points) == 1 else f"{job.name}: {reason}"


def _begun(began: dict[str, float], name: str, board: Board) -> Watcher:
    began.setdefault(name, time.monotonic())
    return board.of(name)


def log_job(job: SweepJob, failures: Failures, watcher: Watcher) -> None:
    """Log the points of a job that have a result."""
    if not job.gray:
        log_points([p for p in job.points if p.key not in failures], job.sweep, watcher)
