"""How a stage speaks to whoever watches it. The terminal implements this; stages print nothing."""

from __future__ import annotations

from typing import Protocol


class Watcher(Protocol):
    def say(self, line: str) -> None:
        """A fact worth a line: what is done and why, or where something went."""

    def warn(self, line: str) -> None:
        """A fact that must not be overlooked."""

    def carry_on(self) -> None:
        """Raises if the person watching has asked to stop, though a library may have hidden it."""

    def progress(self, work: str, state: str, fraction: float | None) -> None:
        """How far a long ``work`` is: its ``state`` in words, the ``fraction`` done where it is known."""
