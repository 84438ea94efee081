"""Figures drawn one by one: of those that cannot be drawn, a warning says why, and the others are drawn."""

from __future__ import annotations

import gc
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
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


@contextmanager
def fresh_garbage_alone() -> Iterator[None]:
    """Exclude the objects that exist now from garbage collection.

    A figure makes so many objects that a full collection would follow every second figure, for 0.1 s each.
    """
    gc.freeze()
    try:
        yield
    finally:
        gc.unfreeze()


def drawn_one(name: str, draw: Callable[[], Plot]) -> tuple[Plot | None, str]:
    """The plot, or None and why it cannot be drawn."""
    try:
        return draw(), ""
    except (ValueError, ArithmeticError) as error:
        return None, f"figure {name} cannot be drawn: {error}"
