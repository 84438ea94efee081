"""Progress of parallel tasks on one terminal: each line says which task of how many, and the time elapsed."""

from __future__ import annotations

import time
from dataclasses import dataclass

from pipelines.shared.watch import Watcher


class Board:
    """Reports on the tasks ``names`` of a job called ``whole`` to ``watcher``."""

    def __init__(self, whole: str, names: list[str], watcher: Watcher) -> None:
        self._whole, self._names, self._watcher = whole, names, watcher
        self._began = time.monotonic()
        self._done = 0
        self._states: dict[str, str] = {}

    def of(self, name: str) -> Watcher:
        """The watcher of one task."""
        return _Labelled(name, self)

    def line(self, name: str, line: str) -> str:
        """``line`` with the elapsed time and the task's number and name before it."""
        number = self._names.index(name) + 1
        return f"[{self._elapsed()}] {number} of {len(self._names)} {name}: {line}"

    def say(self, name: str, line: str) -> None:
        """Report a fact about the task ``name``."""
        self._watcher.say(self.line(name, line))

    def warn(self, name: str, line: str) -> None:
        """Report a warning about the task ``name``."""
        self._watcher.warn(self.line(name, line))

    def carry_on(self) -> None:
        """Raise if the user has asked to stop."""
        self._watcher.carry_on()

    def progress(self, name: str, state: str) -> None:
        """Show ``state`` of the task ``name`` beside those of the other running tasks."""
        self._states[name] = state
        now = " | ".join(f"{name}: {state}" for name, state in self._states.items())
        total = len(self._names)
        self._watcher.progress(self._whole, f"{self._done} of {total} done, {self._elapsed()}; {now}", None)

    def done(self, name: str, seconds: float) -> None:
        """Report that the task ``name`` has finished after ``seconds``."""
        self._end(name)
        self.say(name, f"done in {seconds:.0f} s; {self._done} of {len(self._names)} are done")

    def failed(self, name: str, reason: str) -> None:
        """Report that the task ``name`` has failed."""
        self._end(name)
        self.warn(name, f"failed: {reason}")

    def _end(self, name: str) -> None:
        self._done += 1
        self._states.pop(name, None)

    def _elapsed(self) -> str:
        minutes, seconds = divmod(round(time.monotonic() - self._began), 60)
        return f"{minutes}:{seconds:02d}"


@dataclass(frozen=True)
class _Labelled:
    """The watcher of one task on the board."""

    name: str
    board: Board

    def say(self, line: str) -> None:
        self.board.say(self.name, line)

    def warn(self, line: str) -> None:
        self.board.warn(self.name, line)

    def carry_on(self) -> None:
        self.board.carry_on()

    def progress(self, work: str, state: str, fraction: float | None) -> None:
        self.board.progress(self.name, f"{work}: {state}")
