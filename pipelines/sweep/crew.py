"""Who carries out the jobs of a sweep: processes of this machine, or whatever a launcher reaches."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Protocol

from pipelines.shared.board import Board
from pipelines.shared.pool import Lost, side_by_side
from pipelines.shared.watch import Watcher
from pipelines.sweep.log import log_points
from pipelines.sweep.work import Failures, Work, carry_out

Ended = Callable[[Work, Failures], None]


class Crew(Protocol):
    @property
    def cores(self) -> int | None:
        """How many jobs run at a time; None: as many as there are."""

    def carry_out(self, works: Sequence[Work], watcher: Watcher, ended: Ended) -> Failures:
        """Do all jobs; says why points have no result. One job that dies does not touch the others.

        ``ended`` is told of each job that nobody else has logged.
        """


@dataclass(frozen=True)
class Here:
    """``cores`` processes of one thread on this machine."""

    cores: int

    def carry_out(self, works: Sequence[Work], watcher: Watcher, ended: Ended) -> Failures:
        failures: dict[str, str] = {}
        names = {work.name: work for work in works}
        board = Board("sweep", list(names), watcher)
        began: dict[str, float] = {}
        for name, outcome in side_by_side(carry_out, names, self.cores, lambda n: _begun(began, n, board)):
            of_job = outcome
            if isinstance(of_job, Lost):
                of_job = {point.key: died(names[name], of_job.reason) for point in names[name].points}
            failures |= of_job
            if of_job:
                lost = "" if len(of_job) == 1 else f"{len(of_job)} points: "
                board.failed(name, lost + next(iter(of_job.values())))
            else:
                board.done(name, time.monotonic() - began[name])
            ended(names[name], of_job)
        return failures


def died(work: Work, reason: str) -> str:
    """Why points of a job that ended without a word have no result."""
    return reason if len(work.points) == 1 else f"{work.name}: {reason}"


def _begun(began: dict[str, float], name: str, board: Board) -> Watcher:
    began.setdefault(name, time.monotonic())
    return board.of(name)


def log_work(work: Work, failures: Failures, watcher: Watcher) -> None:
    """Log the points of a job that have a result."""
    if not work.gray:
        log_points([p for p in work.points if p.key not in failures], work.sweep, watcher)
