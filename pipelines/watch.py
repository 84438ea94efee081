"""How a stage speaks to whoever watches it. The terminal implements this; stages print nothing."""

from __future__ import annotations

from typing import Protocol

from hybridid.estimators.estimate import Progress


class Watcher(Protocol):
    def say(self, line: str) -> None:
        """A fact worth a line: what is done and why, or where something went."""

    def warn(self, line: str) -> None:
        """A fact that must not be overlooked."""

    def progress(self, progress: Progress) -> None:
        """How far a long computation is."""
