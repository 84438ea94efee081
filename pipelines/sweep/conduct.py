"""Runs a sweep from its points to their results; failed points are reported, the others have results."""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from pipelines.runner import check_stages, is_fresh
from pipelines.shared.config import digest_of
from pipelines.shared.errors import ConfigError
from pipelines.shared.freshness import RECEIPT
from pipelines.shared.sections.searches import SweepSection
from pipelines.shared.sources import sources_of
from pipelines.shared.storage import write_json
from pipelines.shared.watch import Watcher
from pipelines.sweep.job_runner import JobRunner, OnJobEnd, log_job
from pipelines.sweep.log import log_failures, log_points
from pipelines.sweep.plan import Plan, planned
from pipelines.sweep.point import Point
from pipelines.sweep.work import Failures, SweepJob
from pipelines.tracking.parent_run import ParentRun
from pipelines.tracking.patience import in_background


@dataclass(frozen=True, eq=False)
class Sweep:
    """A sweep as requested: its ``name``, the overrides typed (``words``), those that all points have in
    ``common``, the ``points``, and the ``folder`` of its report."""

    name: str
    words: tuple[str, ...]
    common: tuple[str, ...]
    points: tuple[Point, ...]
    folder: Path

    @property
    def key(self) -> str:
        """A digest of the points, independent of their order."""
        return key_of(self.points)


@dataclass(frozen=True, eq=False)
class SweepOutcome:
    """The outcome of a sweep: ``failures`` are the points without a result, and why."""

    sweep: Sweep
    plan: Plan
    failures: Mapping[Point, str]
    seconds: float

    @property
    def done(self) -> list[Point]:
        """The points with a result."""
        return [point for point in self.sweep.points if point not in self.failures]


def folder_of(name: str, points: Sequence[Point]) -> Path:
    """``out``, else ``paths.outputs``/sweeps/<name>-<digest>: the same request finds the same folder.

    A sweep over a virtual rig says ``-simulated``, as its points' trees do.
    """
    settings = points[0].settings
    if settings.get("out") is not None:
        return Path(str(settings["out"]))
    mark = "-simulated" if any(point.simulated for point in points) else ""
    return settings.outputs / "sweeps" / f"{name}-{key_of(points)}{mark}"


def key_of(points: Sequence[Point]) -> str:
    """Eight hexadecimal digits that identify the set of points."""
    return digest_of(sorted([point.settings.case, point.key] for point in points))[:8]


def conduct(
    sweep: Sweep, runner: JobRunner, request: SweepSection, parent: ParentRun, watcher: Watcher
) -> SweepOutcome:
    """Compute the missing results of the sweep, and log its points below ``parent``, which is opened.

    Raises:
        ConfigError: if the config of every point is wrong.
    """
    began = time.time()
    refused = _refused(sweep.points, watcher)
    sound = [point for point in sweep.points if point not in refused]
    plan = _planned(sound, runner, request, sweep.key)
    for line in plan.lines:
        watcher.say(f"plan: {line}")
    write_json(sweep.folder / "plan.json", plan.described)
    before = {point: _made(point) for job in plan.jobs for point in job.points}
    with in_background() as log:
        log(parent.open, about(sweep))
        log(log_points, plan.fresh, sweep.key, watcher)
        reasons = _carried_out(
            plan, runner, watcher, lambda job, failures: log(log_job, job, failures, watcher)
        )
    lost = {p: reasons.get(p.key, "its job left no result") for p, old in before.items() if _made(p) == old}
    failures = {p: (refused | lost)[p] for p in sweep.points if p in refused or p in lost}
    log_failures(failures, sweep.key, began, watcher)
    return SweepOutcome(sweep, plan, failures, time.time() - began)


def _refused(points: Sequence[Point], watcher: Watcher) -> dict[Point, str]:
    """Points with a wrong config, and why. Remarks on the data that all points share are reported once."""
    refused: dict[Point, str] = {}
    remarks: dict[str, None] = {}
    for point in points:
        watcher.carry_on()
        try:
            check_stages(point.settings, point.last)
            remarks |= dict.fromkeys(sources_of(point.settings).remarks)
        except ValueError as error:
            refused[point] = str(error)
    if len(refused) == len(points):
        raise ConfigError(next(iter(refused.values())))
    for remark in remarks:
        watcher.warn(remark)
    return refused


def _planned(points: Sequence[Point], runner: JobRunner, request: SweepSection, key: str) -> Plan:
    fresh = [p for p in points if not p.settings.lone.force and is_fresh(p.settings, p.last, p.tree)]
    grays = {p.gray_tree: p for p in points if p not in fresh and p.kind is not None}
    there = [p for p in grays.values() if is_fresh(p.gray, "fit", p.gray_tree)]
    plan = planned(points, fresh, there, runner.cores, request.stack)
    jobs = tuple(replace(job, sweep=key) for job in plan.jobs)
    return replace(plan, jobs=jobs)


def _carried_out(plan: Plan, runner: JobRunner, watcher: Watcher, ended: OnJobEnd) -> dict[str, str]:
    """Fit the gray boxes, then run the jobs whose gray box was fitted; returns why points have no result."""
    of_grays = runner.carry_out(plan.grays, watcher, lambda job, failures: None) if plan.grays else {}
    lost = {
        job.points[0].gray_tree: of_grays[job.points[0].key]
        for job in plan.grays
        if job.points[0].key in of_grays
    }
    reasons: dict[str, str] = {}
    jobs: list[SweepJob] = []
    for job in plan.jobs:
        reasons |= {p.key: f"its gray box: {lost[p.gray_tree]}" for p in job.points if p.gray_tree in lost}
        left = tuple(point for point in job.points if point.gray_tree not in lost)
        jobs += [replace(job, points=left)] if left else []
    found: Failures = runner.carry_out(jobs, watcher, ended) if jobs else {}
    return {**reasons, **found}


def _made(point: Point) -> int | None:
    """The modification time of its result; None if it has none.

    Freshness is no measure here: if the code is edited during a sweep, new results look stale at once.
    """
    try:
        return (point.tree / point.last / RECEIPT).stat().st_mtime_ns
    except OSError:
        return None


def about(sweep: Sweep) -> dict[str, str]:
    """Tags of the sweep's own run in MLflow."""
    return {"words": " ".join(sweep.words), "folder": str(sweep.folder.resolve())}
