"""A sweep from its points to their results; what fails is named, the rest is there."""

from __future__ import annotations

import hashlib
import json
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from pipelines.runner import check_stages, is_fresh
from pipelines.shared.errors import ConfigError
from pipelines.shared.freshness import RECEIPT
from pipelines.shared.sections.searches import SweepSection
from pipelines.shared.sources import sources_of
from pipelines.shared.storage import write_json
from pipelines.shared.watch import Watcher
from pipelines.sweep.crew import Crew, Ended, log_work
from pipelines.sweep.log import common, log_failures, log_points
from pipelines.sweep.plan import Plan, planned
from pipelines.sweep.point import Point
from pipelines.sweep.work import Failures, Work
from pipelines.tracking.patience import in_background
from pipelines.tracking.runs import open_parent


@dataclass(frozen=True, eq=False)
class Sweep:
    """What is asked for: ``points``, called ``name``, by the ``words`` typed; ``common`` of them go for every
    point. ``folder`` is for the report."""

    name: str
    words: tuple[str, ...]
    common: tuple[str, ...]
    points: tuple[Point, ...]
    folder: Path

    @property
    def key(self) -> str:
        """Equal for equal requests, in whatever order."""
        return digest_of(self.points)


@dataclass(frozen=True, eq=False)
class Swept:
    """What became of it: ``failures`` are the points without a result, and why."""

    sweep: Sweep
    plan: Plan
    failures: Mapping[Point, str]
    seconds: float

    @property
    def done(self) -> list[Point]:
        return [point for point in self.sweep.points if point not in self.failures]


def folder_of(name: str, points: Sequence[Point]) -> Path:
    """``out``, else ``paths.outputs``/sweeps/<name>-<digest>: the same request finds the same folder.

    A sweep over a virtual rig says ``-simulated``, as its points' trees do.
    """
    settings = points[0].settings
    if settings.get("out") is not None:
        return Path(str(settings["out"]))
    mark = "-simulated" if any(point.simulated for point in points) else ""
    return Path(str(settings["paths.outputs"])) / "sweeps" / f"{name}-{digest_of(points)}{mark}"


def digest_of(points: Sequence[Point]) -> str:
    """Eight hexadecimal digits of what is asked for: the same again finds the same folder."""
    text = json.dumps(sorted([point.settings.case, point.key] for point in points))
    return hashlib.sha256(text.encode()).hexdigest()[:8]


def conduct(sweep: Sweep, crew: Crew, request: SweepSection, watcher: Watcher) -> Swept:
    """Do what is missing of the sweep.

    Raises:
        ConfigError: if no point can be carried out.
    """
    began = time.time()
    refused = _refused(sweep.points, watcher)
    sound = [point for point in sweep.points if point not in refused]
    plan = _planned(sound, crew, request, sweep.key)
    for line in plan.lines:
        watcher.say(f"plan: {line}")
    write_json(sweep.folder / "plan.json", plan.described)
    before = {point: _made(point) for work in plan.jobs for point in work.points}
    with in_background() as log:
        log(open_parent, common(sweep.points), sweep.name, sweep.key, about(sweep), watcher)
        log(log_points, plan.fresh, sweep.key, watcher)
        reasons = _carried_out(
            plan, crew, watcher, lambda work, failures: log(log_work, work, failures, watcher)
        )
    lost = {p: reasons.get(p.key, "its job left no result") for p, old in before.items() if _made(p) == old}
    failures = {p: (refused | lost)[p] for p in sweep.points if p in refused or p in lost}
    log_failures(failures, sweep.key, began, watcher)
    return Swept(sweep, plan, failures, time.time() - began)


def _refused(points: Sequence[Point], watcher: Watcher) -> dict[Point, str]:
    """Points whose config cannot be carried out, before anything is; what is odd of the data is said once."""
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


def _planned(points: Sequence[Point], crew: Crew, request: SweepSection, key: str) -> Plan:
    fresh = [p for p in points if not p.settings.lone.force and _fresh(p)]
    grays = {p.gray_tree: p for p in points if p not in fresh and p.kind is not None}
    there = [p for p in grays.values() if is_fresh(p.gray, "fit", p.gray_tree)]
    plan = planned(points, fresh, there, crew.cores, request.stack)
    jobs = tuple(replace(work, sweep=key) for work in plan.jobs)
    return replace(plan, jobs=jobs)


def _carried_out(plan: Plan, crew: Crew, watcher: Watcher, ended: Ended) -> dict[str, str]:
    """Gray boxes, then all that stands on those that there are; why points have no result."""
    of_grays = crew.carry_out(plan.grays, watcher, lambda work, failures: None) if plan.grays else {}
    lost = {
        work.points[0].gray_tree: of_grays[work.points[0].key]
        for work in plan.grays
        if work.points[0].key in of_grays
    }
    reasons: dict[str, str] = {}
    jobs: list[Work] = []
    for work in plan.jobs:
        reasons |= {p.key: f"its gray box: {lost[p.gray_tree]}" for p in work.points if p.gray_tree in lost}
        left = tuple(point for point in work.points if point.gray_tree not in lost)
        jobs += [replace(work, points=left)] if left else []
    found: Failures = crew.carry_out(jobs, watcher, ended) if jobs else {}
    return {**reasons, **found}


def _made(point: Point) -> int | None:
    """When its result was made, by the clock of the file system; None if it has none.

    Not whether it is fresh: who edits hybridid during a sweep still has what the sweep made.
    """
    try:
        return (point.tree / point.last / RECEIPT).stat().st_mtime_ns
    except OSError:
        return None


def _fresh(point: Point) -> bool:
    return is_fresh(point.settings, point.last, point.tree)


def about(sweep: Sweep) -> dict[str, str]:
    """What the sweep's own run says of it."""
    return {"words": " ".join(sweep.words), "folder": str(sweep.folder.resolve())}
