"""What MLflow is to hold of one run, as plain data: sent at once, or kept in a file and sent later."""

from __future__ import annotations

import time
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Literal

from hybridid.plain import plain
from pipelines.shared.config import digest_of
from pipelines.shared.errors import ConfigError, Incomplete
from pipelines.shared.secrets import masked

Status = Literal["RUNNING", "FINISHED", "FAILED", "KILLED"]
KEY = "hybridid.key"
"""The tag by which a run is found again: two notes of one key fill one run."""
COMMIT, CHANGED = "mlflow.source.git.commit", "git.changed"
"""Tags: the commit of the code that made the result, and whether its files were changed since."""
LONGEST = 6000
"""Characters that MLflow takes for a parameter."""


@dataclass(frozen=True)
class Metric:
    """A number to log, with its step."""

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

    def closed(self, status: Status, error: str) -> Note:
        """The note that ends this run now, and says why."""
        about = {"tags": {"error": error}, "params": {}, "metrics": (), "artifacts": ()}
        return replace(self, ended=round(time.time() * 1000), status=status, **about)  # type: ignore[arg-type]

    @property
    def digest(self) -> str:
        """Equal for two notes of one result, wherever its files lie and by whatever code it is logged."""
        tags = {name: tag for name, tag in self.tags.items() if name not in (COMMIT, CHANGED)}
        files = sorted(a.into for a in self.artifacts)
        return digest_of({**plain(self), "tags": tags, "artifacts": files, "uri": None})[:16]


def short(text: object) -> str:
    """Text as one line that MLflow takes, without secrets."""
    return " ".join(masked(text).split())[:LONGEST]


def raised(error: BaseException, most: int = LONGEST) -> str:
    """An exception in one line, its class first."""
    return short(f"{type(error).__name__}: {error}")[:most]


def one_line(error: Exception, most: int = 300) -> str:
    """The same, without the class where the message is complete."""
    return short(error)[:most] if isinstance(error, (ConfigError, Incomplete)) else raised(error, most)
