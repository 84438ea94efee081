"""What MLflow is to hold of one run, as plain data: sent at once, or kept in a file and sent later."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from typing import Any, Literal

Status = Literal["RUNNING", "FINISHED", "FAILED"]
KEY = "hybridid.key"
"""The tag by which a run is found again: two notes of one key fill one run."""
COMMIT, CHANGED = "mlflow.source.git.commit", "git.changed"
"""Tags: the commit of the code that made the result, and whether its files were changed since."""
LONGEST = 6000
"""Characters that MLflow takes for a parameter."""


@dataclass(frozen=True)
class Metric:
    name: str
    value: float
    step: int = 0


@dataclass(frozen=True)
class Artifact:
    """A file or a folder to be kept with the run, below ``into``."""

    source: Path
    into: str = ""


@dataclass(frozen=True)
class Note:
    """One run. ``uri`` None is the store beside the run trees; ``parent`` the key of the run it belongs to.

    ``began`` and ``ended`` are in ms since 1970; ``ended`` None: it goes on.
    """

    key: str
    name: str
    experiment: str
    uri: str | None
    began: int
    ended: int | None = None
    status: Status = "RUNNING"
    parent: str | None = None
    tags: Mapping[str, str] = field(default_factory=dict)
    params: Mapping[str, str] = field(default_factory=dict)
    metrics: tuple[Metric, ...] = ()
    artifacts: tuple[Artifact, ...] = ()

    @property
    def digest(self) -> str:
        """Equal for two notes of one result, wherever its files lie and by whatever code it is logged."""
        tags = {name: tag for name, tag in self.tags.items() if name not in (COMMIT, CHANGED)}
        files = sorted(a.into for a in self.artifacts)
        said = {**self.plain(), "tags": tags, "artifacts": files, "uri": None}
        return hashlib.sha256(json.dumps(said, sort_keys=True).encode()).hexdigest()[:16]

    def plain(self) -> dict[str, Any]:
        """As JSON takes it."""
        artifacts = [{"source": str(a.source), "into": a.into} for a in self.artifacts]
        return {**asdict(replace(self, artifacts=())), "artifacts": artifacts}

    @classmethod
    def of(cls, data: Mapping[str, Any]) -> Note:
        """What ``plain`` gave."""
        metrics = tuple(Metric(**one) for one in data["metrics"])
        artifacts = tuple(Artifact(Path(one["source"]), one["into"]) for one in data["artifacts"])
        return cls(**{**data, "metrics": metrics, "artifacts": artifacts})


def short(text: object) -> str:
    """Text as one line that MLflow takes."""
    return " ".join(str(text).split())[:LONGEST]
