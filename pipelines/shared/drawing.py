"""Figures drawn one by one: of those that cannot be drawn, a warning says why, and the others are drawn."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from typing import TypeVar

from pipelines.shared.watch import Watcher

Plot = TypeVar("Plot")


def drawn(figures: Iterable[tuple[str, Callable[[], Plot]]], watcher: Watcher) -> Iterator[tuple[str, Plot]]:
    """Name and plot of each figure that can be drawn: some records are too short, some numbers infinite."""
    for name, draw in figures:
        plot, trouble = drawn_one(name, draw)
        if plot is None:
            watcher.warn(trouble)
        else:
            yield name, plot


def drawn_one(name: str, draw: Callable[[], Plot]) -> tuple[Plot | None, str]:
    """The plot, or None and why it cannot be drawn."""
    try:
        return draw(), ""
    except (ValueError, ArithmeticError) as error:
        return None, f"figure {name} cannot be drawn: {error}"
