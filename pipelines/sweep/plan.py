"""The plan of a sweep: which points train together, which train alone, and on how many cores.

The time of a training step is the overhead of the library calls plus the multiplications. In units of one
multiplication, for each sample,

    cost = depth * (CALL + networks * width²) + networks * RUN

with depth and width of the largest network in a stack. For small networks the overhead ``CALL`` is most of
the time, so a stack of many takes hardly longer than one; wide networks gain nothing. ``RUN`` is the free run
on the held-out blocks, one network after another. Both constants were measured on one thread: stacks of 1 and
8 networks, 8 to 256 neurons wide. With ``residual.optimiser=lbfgs`` networks train one after another: the
cost of each is depth * (ALONE + width²).
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from hybridid.naming import counted
from hybridid.residuals.settings import SMALL
from pipelines.sweep.point import GRIDS, Point
from pipelines.sweep.work import SweepJob

CALL = 12_000.0
RUN = 4_000.0
ALONE = 300.0
A_JOB = 16
"""Points in a stack at most where jobs go to other machines: a job that is lost costs no more."""


@dataclass(frozen=True)
class PlannedJob:
    """Points, by name, that one process does."""

    name: str
    points: tuple[str, ...]


@dataclass(frozen=True)
class PlannedWork:
    """``plan.json``: the jobs on so many ``cores`` (None: other machines), and ``why`` in words.

    The ``gray_boxes``, by the folders of their run trees, are fitted first; ``fresh`` points need nothing.
    """

    cores: int | None
    why: tuple[str, ...]
    gray_boxes: tuple[str, ...] = field(metadata={"key": "gray boxes"})
    jobs: tuple[PlannedJob, ...]
    fresh: tuple[str, ...]


@dataclass(frozen=True)
class Plan:
    """``grays`` are done before ``jobs``; ``fresh`` are the points that need nothing."""

    cores: int | None
    grays: tuple[SweepJob, ...]
    jobs: tuple[SweepJob, ...]
    fresh: tuple[Point, ...]
    lines: tuple[str, ...]

    @property
    def described(self) -> PlannedWork:
        """The plan by the names of its points."""
        return PlannedWork(
            cores=self.cores,
            why=self.lines,
            gray_boxes=tuple(job.points[0].gray_tree.name for job in self.grays),
            jobs=tuple(PlannedJob(job.name, tuple(p.name for p in job.points)) for job in self.jobs),
            fresh=tuple(point.name for point in self.fresh),
        )


def planned(
    points: Sequence[Point],
    fresh: Iterable[Point],
    fresh_grays: Iterable[Point],
    cores: int | None,
    most: int | None = None,
) -> Plan:
    """Jobs for the points that are not ``fresh``, on ``cores`` (None: other machines, as many as it takes).

    A gray box is done first unless its point is of ``fresh_grays``; ``most`` points are in one stack at most.
    """
    there, known = set(fresh), {point.gray_tree for point in fresh_grays}
    missing = [point for point in points if point not in there]
    grays = {p.gray_tree: p for p in missing if p.kind is not None and p.gray_tree not in known}
    small = [point for point in missing if _is_small(point)]
    large = [point for point in missing if not _is_small(point)]
    groups = _alike(small)
    share = None if cores is None else -(-cores // max(len(groups), 1))
    stacks = [stack for group in groups for stack in _stacks(group, share, most)]
    jobs = sorted([*stacks, *((point,) for point in large)], key=cost, reverse=True)
    return Plan(
        cores,
        tuple(SweepJob(f"gray box {k}", (p,), gray=True) for k, p in enumerate(grays.values(), 1)),
        tuple(SweepJob(_name(job, k), tuple(job)) for k, job in enumerate(jobs, 1)),
        tuple(point for point in points if point in there),
        tuple(_words(points, missing, stacks, large, cores)),
    )


def cost(points: Sequence[Point]) -> float:
    """Of a step of training, relative to others; points without a NARX network count as long."""
    if any(point.kind != "narx" for point in points):
        return float("inf")
    if points[0].settings.get("residual.optimiser") == "lbfgs":
        return sum(_number(p, "depth") * (_number(p, "width") ** 2 + ALONE) for p in points)
    depth, width = (max(_number(p, key) for p in points) for key in ("depth", "width"))
    networks = len(points)
    return depth * (CALL + networks * width**2) + networks * RUN


def _name(job: Sequence[Point], number: int) -> str:
    return (job[0].name or job[0].settings.case) if len(job) == 1 else f"stack {number} of {len(job)} points"


def _is_small(point: Point) -> bool:
    return point.kind == "narx" and _number(point, "width") <= SMALL


def _number(point: Point, key: str) -> float:
    value = point.settings.get(f"residual.{key}")
    return float(value) if isinstance(value, int | float) else 0.0


def _alike(points: Sequence[Point]) -> list[list[Point]]:
    """Points whose networks may share a stack: one gray box, and all else equal but size, orders and seed."""
    groups: dict[tuple[Any, ...], list[Point]] = {}
    for point in points:
        residual: Mapping[str, Any] = point.settings["residual"]
        free = (*GRIDS["narx"], "orders")
        rest = sorted((key, str(value)) for key, value in residual.items() if key not in free)
        groups.setdefault((point.gray_tree, *rest), []).append(point)
    return list(groups.values())


def _stacks(points: Sequence[Point], cores: int | None, most: int | None) -> list[tuple[Point, ...]]:
    """Stacks of similar sizes, one per core or of ``A_JOB`` points. The largest cost of any is minimal."""
    count = -(-len(points) // A_JOB) if cores is None else min(cores, len(points))
    if most is not None:
        count = max(count, -(-len(points) // most))
    ordered = sorted(points, key=lambda p: (_number(p, "width"), _number(p, "depth")))
    low, high = 0.0, cost(ordered)
    for _ in range(40):  # bisection: the smallest limit that ``count`` stacks can keep
        middle = (low + high) / 2
        if len(_cut(ordered, middle, most)) <= count:
            high = middle
        else:
            low = middle
    return _cut(ordered, high, most)


def _cut(points: Sequence[Point], limit: float, most: int | None) -> list[tuple[Point, ...]]:
    """The points in order, a new stack where one would cost above ``limit`` or hold more than ``most``."""
    stacks: list[tuple[Point, ...]] = []
    begun: tuple[Point, ...] = ()
    for point in points:
        if begun and (cost((*begun, point)) > limit or len(begun) == most):
            stacks.append(begun)
            begun = ()
        begun = (*begun, point)
    return [*stacks, begun]


def _reason(stacks: Sequence[Sequence[Point]]) -> str:
    """Why points train together."""
    if all(stack[0].settings.get("residual.optimiser") == "lbfgs" for stack in stacks):
        return "one after another in one process, so that it starts and scores once"
    return f"with at most {SMALL} neurons a layer, many networks take hardly more time than one"


def _words(
    points: Sequence[Point],
    missing: Sequence[Point],
    stacks: Sequence[Sequence[Point]],
    large: Sequence[Point],
    cores: int | None,
) -> Iterable[str]:
    """The plan in one or two lines."""
    where = "on other machines" if cores is None else f"on {cores} core{'s' * (cores > 1)}"
    every, fresh = counted(len(points), "point"), len(points) - len(missing)
    yield f"{every}, {fresh} of them fresh, {len(missing)} to do {where}"
    together = [stack for stack in stacks if len(stack) > 1]
    if together:
        sizes = " + ".join(str(len(stack)) for stack in together)
        yield (
            f"{sum(map(len, together))} points train together in {len(together)} "
            f"stack{'s' * (len(together) > 1)} ({sizes}): {_reason(together)}"
        )
    alone = len(large) + len(stacks) - len(together)
    if alone:
        own = "point is a job of its own" if alone == 1 else "points are jobs of their own"
        yield f"{alone} {own}, in a worker of one thread"
