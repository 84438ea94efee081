"""What is known of a run, as MLflow takes it: tags, parameters, metrics and files."""

from __future__ import annotations

import functools
import math
import subprocess
from collections.abc import Mapping
from pathlib import Path

from pipelines.shared.config import Settings, flat
from pipelines.shared.prepared import provenance_of
from pipelines.shared.stage import Outcome
from pipelines.tracking.metrics import cost_history, facts, metrics_of
from pipelines.tracking.note import CHANGED, COMMIT, Artifact, Metric, short


def about(settings: Settings, command: str) -> dict[str, str]:
    """What every run says: its command and case, the commit of the code."""
    return {"command": command, "case": settings.case, **_commit()}


def parameters(settings: Settings) -> dict[str, str]:
    """The config by flat keys."""
    return {k: short(v) for k, v in flat(settings.config).items() if k != "case.source"}


def finite(metrics: Mapping[str, float]) -> tuple[Metric, ...]:
    """Those that are numbers."""
    return tuple(Metric(name, float(value)) for name, value in metrics.items() if math.isfinite(value))


def tags_of(outcome: Outcome) -> dict[str, str]:
    """Where the results are, which stages made them, and from which data."""
    return {
        "tree": str(outcome.tree.resolve()),
        "stages.ran": ", ".join(outcome.ran) or "none",
        "stages.reused": ", ".join(outcome.reused) or "none",
        "provenance": provenance_of(outcome.tree),
        **facts(outcome.tree, outcome.folders.get("trace")),
    }


def metrics_of_run(outcome: Outcome) -> tuple[Metric, ...]:
    """Every number that the stages found, and the course of the fit's cost."""
    found = finite(metrics_of(outcome.tree, outcome.stages, outcome.folders.get("trace")))
    if "fit" not in outcome.stages:
        return found
    costs = enumerate(cost_history(outcome.tree))
    return (*found, *(Metric("cost", cost, step) for step, cost in costs if math.isfinite(cost)))


def artifacts_of(outcome: Outcome) -> tuple[Artifact, ...]:
    """The config and the stages' folders; records stay where they are: their digests are logged."""
    stages = [stage for stage in outcome.stages if stage != "preprocess"]
    return (
        Artifact(outcome.tree / "config.yaml"),
        *(Artifact(outcome.folders[stage], stage) for stage in stages),
    )


@functools.cache
def _commit() -> dict[str, str]:
    """The commit of the checkout that hybridid runs from, if it is one; of when this process began to log."""
    home = Path(__file__).resolve().parents[2]
    try:
        if Path(_git(home, "rev-parse", "--show-toplevel")).resolve() != home:
            return {}  # installed somewhere inside another repository
        changed = bool(_git(home, "status", "--porcelain", "--untracked-files=no"))
        return {COMMIT: _git(home, "rev-parse", "HEAD"), CHANGED: str(changed).lower()}
    except (OSError, subprocess.SubprocessError):
        return {}


def _git(folder: Path, *words: str) -> str:
    said = subprocess.run(
        ["git", "-C", str(folder), *words], capture_output=True, text=True, check=True, timeout=5
    )
    return said.stdout.strip()
