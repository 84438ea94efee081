"""A sweep's points in MLflow: each a run of its own below the sweep's."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import reduce
from typing import Any

from pipelines.shared.config import Settings
from pipelines.shared.freshness import RECEIPT
from pipelines.shared.prepared import provenance_of
from pipelines.shared.storage import read_json
from pipelines.shared.watch import Watcher
from pipelines.sweep.point import Point
from pipelines.tracking.facts import parameters
from pipelines.tracking.metrics import facts, metrics_of
from pipelines.tracking.runs import Point as Logged
from pipelines.tracking.runs import log_point


def common(points: Sequence[Point]) -> Settings:
    """The config of the sweep's own run: that of the points without the keys in which they differ."""
    first, *others = points
    config = reduce(_shared, (point.settings.config for point in others), first.settings.config)
    return replace(first.settings, config=config)


def _shared(one: Mapping[str, Any], other: Mapping[str, Any]) -> Mapping[str, Any]:
    shared: dict[str, Any] = {}
    for key, value in one.items():
        if isinstance(value, Mapping) and isinstance(other.get(key), Mapping):
            shared[key] = _shared(value, other[key])
        elif key in other and other[key] == value:
            shared[key] = value
    return shared


def in_one_experiment(points: Sequence[Point], name: str) -> list[Point]:
    """The points; those of several cases all in one experiment ``name``.

    MLflow cannot nest a run below one of another experiment.
    """
    if len({point.settings.case for point in points}) == 1:
        return list(points)
    return [_in_experiment(point, name) for point in points]


def _in_experiment(point: Point, name: str) -> Point:
    logging = dict(point.settings.get("mlflow") or {})
    config = {**point.settings.config, "mlflow": {**logging, "experiment": logging.get("experiment") or name}}
    return Point(replace(point.settings, config=config), point.at)


def log_points(points: Sequence[Point], sweep: str, watcher: Watcher) -> None:
    """Log finished points as runs of ``sweep``, the key of their parent. Repeating it adds no second run."""
    for point in points:
        if point.settings.mlflow.enabled:
            log_point(point.settings, _logged(point, sweep), sweep, watcher)


def log_failures(failures: Mapping[Point, str], sweep: str, began: float, watcher: Watcher) -> None:
    """Log points without a result, and why they have none."""
    for point, reason in failures.items():
        known = parameters(point.settings)
        failed = Logged(_key(point, sweep), point.name, known, {}, began, 0.0, error=reason)
        log_point(point.settings, failed, sweep, watcher)


def _logged(point: Point, sweep: str) -> Logged:
    """The point as read from its files alone, so that it does not matter who logs it and when."""
    stages = tuple(s for s in ("fit", "residual", "validate", "trace") if (point.tree / s / RECEIPT).exists())
    receipt = point.tree / point.last / RECEIPT
    seconds = float(read_json(receipt)["seconds"])
    tree = str(point.tree.resolve())
    return Logged(
        key=_key(point, sweep),
        name=point.name,
        params=parameters(point.settings),
        metrics=metrics_of(point.tree, stages),
        began=receipt.stat().st_mtime - seconds,
        seconds=seconds,
        tags={"tree": tree, "provenance": provenance_of(point.tree), **facts(point.tree)},
        artifacts=[point.tree / "config.yaml", point.tree / point.last],
    )


def _key(point: Point, sweep: str) -> str:
    return f"{sweep}.{point.settings.case}.{point.key}"
