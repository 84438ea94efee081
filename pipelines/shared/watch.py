"""The interface through which stages report progress. The terminal implements it; stages print nothing."""

from __future__ import annotations

from typing import Protocol


class Watcher(Protocol):
    """Receives the reports of a running stage."""

    def say(self, line: str) -> None:
        """Report a fact in one line: what is done and why, or where a file is."""

    def warn(self, line: str) -> None:
        """Report a warning in one line."""

    def carry_on(self) -> None:
        """Raise if the user has asked to stop, even if a library has swallowed the interrupt."""

    def progress(self, work: str, state: str, fraction: float | None) -> None:
        """Report the ``state`` of a long ``work`` in words, and the ``fraction`` done if it is known."""
