"""The types that describe a stage, one run of it, and the outcome of a command."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pipelines.shared.config import Settings
from pipelines.shared.watch import Watcher


@dataclass(frozen=True)
class Job:
    """One run of a stage: reads stage folders under ``tree``, writes into ``folder``.

    ``results`` is the path that ``folder`` gets when all is written. ``key`` is the digest of ``tree``,
    of the code that the stage runs and of the files that it reads, whatever is asked of it.
    """

    settings: Settings
    tree: Path
    folder: Path
    results: Path
    watcher: Watcher
    key: str


@dataclass(frozen=True)
class Stage:
    """A step of the pipeline; it writes the files of one folder of a run tree.

    ``keys`` are the config keys that its results depend on, ``reads`` the stages whose files it reads,
    ``inputs`` gives digests of everything else that it reads. ``check`` raises a ``ConfigError`` for a wrong
    config before any stage runs, ``check_records`` for one that does not suit the prepared records of the run
    tree, before any other stage works on them. If ``asked`` is False for a config, the stage is skipped and
    its earlier result removed. Its code is the module or package ``pipelines.<name>`` and all that this
    imports. ``side_by_side``: its results with other values of ``keys`` stay beside the new ones.
    ``moves_nothing`` are keys among these that change no number, such as how many processes share the work.
    """

    name: str
    keys: tuple[str, ...]
    reads: tuple[str, ...]
    run: Callable[[Job], None]
    inputs: Callable[[Settings], Mapping[str, str]] = lambda settings: {}
    check: Callable[[Settings], None] = lambda settings: None
    check_records: Callable[[Settings, Path], None] = lambda settings, tree: None
    asked: Callable[[Settings], bool] = lambda settings: True
    side_by_side: bool = False
    moves_nothing: tuple[str, ...] = ()

    def options(self, settings: Settings) -> dict[str, Any]:
        """The part of the config that its results depend on, as flat dotted keys."""
        part = settings.part(self.keys)
        return {key: value for key, value in part.items() if key not in self.moves_nothing}


@dataclass(frozen=True)
class Outcome:
    """The outcome of a command: its run tree, the stages now up to date in it, the stages that ran.

    ``folders`` are those of the stages' results, by name.
    """

    tree: Path
    stages: tuple[str, ...]
    ran: tuple[str, ...]
    folders: Mapping[str, Path]

    @property
    def reused(self) -> tuple[str, ...]:
        """The stages whose earlier results were still fresh."""
        return tuple(name for name in self.stages if name not in self.ran)
