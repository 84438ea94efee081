"""A job of a sweep, run by one process: it fits a gray box, or trains the networks of several points."""

from __future__ import annotations

import os
import shutil
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from hybridid.hybrid import GrayBox, GrayRun, errors_of, gray_runs
from hybridid.hybrid.narx_grid import narx_hybrid, train_networks
from pipelines.residual import stage as residual
from pipelines.residual.narx import NARXRequest, report_to
from pipelines.runner import run_stages
from pipelines.shared.freshness import RECEIPT
from pipelines.shared.stage import Job
from pipelines.shared.tree import replacing
from pipelines.shared.watch import Watcher
from pipelines.sweep.point import Point
from pipelines.tracking.note import one_line

if TYPE_CHECKING:
    from hybridid.residuals.training import Trained

SHARED = ("preprocess", "fit")
"""Stages that a point takes over from its gray box."""
Failures = Mapping[str, str]
"""Why points have no result, by their keys."""


@dataclass(frozen=True, eq=False)
class SweepJob:
    """Points that one process computes; if ``gray``, only their common gray box. ``sweep`` is the sweep's
    key."""

    name: str
    points: tuple[Point, ...]
    gray: bool = False
    sweep: str = ""

    @property
    def goes_on(self) -> bool:
        """Whether it would continue after its process was lost. A trace stores its refits. A network trains
        from the start."""
        return self.points[0].is_traced

    def plain(self) -> dict[str, Any]:
        """As JSON takes it."""
        points = [point.plain() for point in self.points]
        return {"name": self.name, "points": points, "gray": self.gray, "sweep": self.sweep}

    @classmethod
    def of(cls, data: Mapping[str, Any]) -> SweepJob:
        """What ``plain`` gave."""
        return cls(**{**data, "points": tuple(Point.of(point) for point in data["points"])})


def carry_out(job: SweepJob, watcher: Watcher) -> Failures:
    """Compute all points of ``job``; returns why points failed. A failed point does not stop the others."""
    quiet = _ProgressOnly(watcher)
    if job.gray:
        return _attempted(job.points, lambda point: run_stages(point.gray, "fit", quiet))
    narx = [point for point in job.points if point.kind == "narx"]
    others = [point for point in job.points if point.kind != "narx"]
    failures = dict(_attempted(others, lambda point: _alone(point, quiet)))
    if not narx:
        return failures
    try:
        _together(narx, quiet)
    except Exception as error:
        if len(narx) == 1:
            return failures | {narx[0].key: one_line(error)}
        failures |= _attempted(narx, lambda point: _together([point], quiet))
    return failures


def adopt(point: Point) -> None:
    """Link the stages of the gray box into the point's tree; copy them where hard links are impossible."""
    for stage in SHARED:
        source, target = point.gray_tree / stage, point.tree / stage
        if _receipt(source) != _receipt(target):
            with replacing(target) as new:
                for path in source.iterdir():
                    _link(path, new / path.name)


def _attempted(points: Sequence[Point], do: Any) -> dict[str, str]:
    failures: dict[str, str] = {}
    for point in points:
        try:
            do(point)
        except Exception as error:
            failures[point.key] = one_line(error)
    return failures


def _alone(point: Point, watcher: Watcher) -> None:
    if point.kind is None:
        run_stages(point.settings, point.last, watcher)
    else:
        run_stages(point.settings, point.last, watcher, first=lambda root: adopt(point))


def _together(points: Sequence[Point], watcher: Watcher) -> None:
    """Train the networks of all points together, then write the result of each point."""
    gray = residual.gray_box(points[0].settings, points[0].gray_tree)
    requests = [_request(point) for point in points]
    began = time.perf_counter()
    runs = gray_runs(gray, requests[0].initial_state)
    errors = errors_of(runs)
    tasks = [request.tasks(gray.model, errors) for request in requests]
    trained = train_networks([t for own in tasks for t in own], requests[0].training, report_to(watcher))
    seconds = (time.perf_counter() - began) / len(points)
    for point, own in zip(points, tasks, strict=True):
        networks, trained = trained[: len(own)], trained[len(own) :]
        _write(point, _Result(gray, runs, networks, seconds), watcher)


@dataclass(frozen=True, eq=False)
class _Result:
    gray: GrayBox
    runs: Sequence[GrayRun]
    networks: Sequence[Trained]
    seconds: float


def _write(point: Point, found: _Result, watcher: Watcher) -> None:
    """Run the stages of a point; the stage ``residual`` takes the networks of ``found``."""

    def run(job: Job) -> None:
        made = narx_hybrid(found.gray, found.runs, found.networks, found.seconds)
        residual.write(job, found.gray, made)

    run_stages(point.settings, point.last, watcher, lambda root: adopt(point), {residual.NAME: run})


def _request(point: Point) -> NARXRequest:
    request = residual.request_of(point.settings)
    assert isinstance(request, NARXRequest)
    return request


def _receipt(folder: Path) -> bytes | None:
    try:
        return (folder / RECEIPT).read_bytes()
    except OSError:
        return None


def _link(source: Path, target: Path) -> None:
    try:
        os.link(source, target)
    except OSError:
        shutil.copy2(source, target)


class _ProgressOnly:
    """Passes on progress, and drops lines and warnings, which would be repeated for every point."""

    def __init__(self, watcher: Watcher) -> None:
        self._watcher = watcher

    def say(self, line: str) -> None:
        self._watcher.carry_on()

    def warn(self, line: str) -> None:
        self._watcher.carry_on()

    def carry_on(self) -> None:
        self._watcher.carry_on()

    def progress(self, work: str, state: str, fraction: float | None) -> None:
        self._watcher.progress(work, state, fraction)
