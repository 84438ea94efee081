"""What a stage is, and what running some did."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path

from pipelines.shared.config import Settings
from pipelines.shared.watch import Watcher


@dataclass(frozen=True)
class Job:
    """One run of a stage: reads stage folders under ``tree``, writes into ``folder``."""

    settings: Settings
    tree: Path
    folder: Path
    watcher: Watcher


@dataclass(frozen=True)
class Stage:
    """Makes the files of one folder of a run tree.

    ``keys`` are the config keys its results depend on, ``reads`` the stages whose files it
    reads, ``inputs`` digests of whatever else it reads. ``check`` raises a ``ConfigError``,
    before anything is done, if the config cannot be carried out. A stage that is not ``asked``
    for by the config is left out, and an older result of it removed. The code of a stage is the module
    or room of its name, ``pipelines.<name>``, and all that this imports.
    """

    name: str
    keys: tuple[str, ...]
    reads: tuple[str, ...]
    run: Callable[[Job], None]
    inputs: Callable[[Settings], Mapping[str, str]] = lambda settings: {}
    check: Callable[[Settings], None] = lambda settings: None
    asked: Callable[[Settings], bool] = lambda settings: True


@dataclass(frozen=True)
class Outcome:
    """What a command did: the run tree, the stages that are now up to date in it, those made anew."""

    tree: Path
    stages: tuple[str, ...]
    ran: tuple[str, ...]

    @property
    def reused(self) -> tuple[str, ...]:
        return tuple(name for name in self.stages if name not in self.ran)
