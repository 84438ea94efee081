"""The search in MLflow: a parent run, and a nested run for each trial."""

from __future__ import annotations

from pipelines.shared.config import Settings
from pipelines.shared.watch import Watcher
from pipelines.tracking.facts import parameters
from pipelines.tracking.runs import Point, log_point
from pipelines.tune.findings import Row, said
from pipelines.tune.request import with_values


def log_trial(settings: Settings, row: Row, parent: str, watcher: Watcher) -> None:
    """Log an ended trial; again is the same again."""
    if row.state in ("running", "stopped"):
        return
    metrics = {} if row.share is None or row.weights is None else _metrics(row)
    point = Point(
        key=f"{parent}.{row.number}",
        name=f"trial {row.number}",
        params=parameters(with_values(settings, row.values)),
        metrics=metrics,
        began=row.began,
        seconds=row.seconds,
        tags={"trial.state": row.state, "trial.values": said(row.values), "trial.remark": row.remark},
        error=row.remark if row.state == "failed" else "",
    )
    log_point(settings, point, parent, watcher)


def _metrics(row: Row) -> dict[str, float]:
    found = {"tune.share": float(row.share or 0.0), "tune.weights": float(row.weights or 0)}
    return found | {f"tune.held_out.{name}": one.held_out for name, one in row.outputs.items()}
