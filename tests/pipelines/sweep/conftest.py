"""Points on the short carriage of ``tests/pipelines``, and a runner that works in this process."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from copy import deepcopy
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import pytest

from pipelines.shared.config import Settings
from pipelines.shared.tree import locked
from pipelines.shared.watch import Watcher
from pipelines.sweep.conduct import Sweep, folder_of
from pipelines.sweep.job_runner import OnJobEnd
from pipelines.sweep.point import Point, expanded
from pipelines.sweep.work import Failures, SweepJob, carry_out


@dataclass
class InProcess:
    """A runner that remembers what it was given; jobs that hold a point of ``kills`` end as if killed."""

    cores: int = 2
    kills: tuple[str, ...] = ()
    grays: list[SweepJob] = field(default_factory=list)
    jobs: list[SweepJob] = field(default_factory=list)

    def carry_out(self, jobs: Sequence[SweepJob], watcher: Watcher, ended: OnJobEnd) -> Failures:
        failures: dict[str, str] = {}
        for job in jobs:
            (self.grays if job.gray else self.jobs).append(job)
            killed = {p.key: "killed" for p in job.points if p.name in self.kills}
            of_job = killed or carry_out(job, watcher)
            failures |= of_job
            ended(job, of_job)
        return failures


@pytest.fixture
def short_grid(narx_grid: dict[str, Any]) -> dict[str, Any]:
    """The small grid with half the training."""
    return {**narx_grid, "epochs": 4, "patience": 4, "precision": "double"}


@pytest.fixture
def config(
    settings: Callable[..., Settings], data: Path, short_grid: dict[str, Any]
) -> Callable[..., Settings]:
    """``config({"residual.depth": 3})``: the short carriage with the small grid and some keys changed."""

    def changed(
        changes: dict[str, Any] | None = None, residual: dict[str, Any] | None = short_grid
    ) -> Settings:
        return settings({"residual": deepcopy(residual), "mlflow.enabled": False, **(changes or {})})

    return changed


@pytest.fixture
def points(config: Callable[..., Settings], short_grid: dict[str, Any]) -> Callable[..., list[Point]]:
    """``points({...}, {...})``: the points of the grid, changed in each of these ways."""

    def made(*changes: dict[str, Any], residual: dict[str, Any] | None = short_grid) -> list[Point]:
        return expanded([(config(one, residual), dict(one)) for one in changes or ({},)])

    return made


@pytest.fixture
def sweep() -> Callable[[Sequence[Point]], Sweep]:
    """``sweep(points)``, its folder made."""

    def made(points: Sequence[Point]) -> Sweep:
        folder = folder_of("short", points)
        with locked(folder, print):
            return Sweep("short", ("case=short",), ("case=short",), tuple(points), folder)

    return made


@pytest.fixture
def runner() -> Callable[..., InProcess]:
    return InProcess
