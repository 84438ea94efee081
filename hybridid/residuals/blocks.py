"""The samples that train a network and those held out: contiguous blocks that contain whole windows."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hybridid.records.masked import pieces

Index = NDArray[np.int64]


@dataclass(frozen=True)
class Blocks:
    """Runs of consecutive grid samples, ``(first, end)`` each."""

    train: tuple[tuple[int, int], ...]
    held_out: tuple[tuple[int, int], ...]

    def starts(self, horizon: int, reach: int) -> Index:
        """Samples where a training window may begin: its ``horizon`` samples and the ``reach``
        past ones that they are predicted from all lie in one run."""
        return np.concatenate([np.arange(a + reach, b - horizon + 1) for a, b in self.train] or [_NONE])

    def checks(self, horizon: int, reach: int) -> Index:
        """First samples of the adjacent windows that cover the held-out runs."""
        return np.concatenate(
            [np.arange(a + reach, b - horizon + 1, horizon) for a, b in self.held_out] or [_NONE]
        )

    def without(self, gaps: NDArray[np.bool_]) -> Blocks:
        """The runs without the ``gaps`` (m,) of the grid, each divided there."""
        if not gaps.any():
            return self
        kept = ~gaps
        return Blocks(*(tuple(_between(part, kept)) for part in (self.train, self.held_out)))


def _between(parts: Sequence[tuple[int, int]], kept: NDArray[np.bool_]) -> Iterator[tuple[int, int]]:
    return ((first + a, first + b) for first, end in parts for a, b in pieces(kept[first:end]))


_NONE = np.empty(0, dtype=np.int64)


def blocks(stretches: list[tuple[int, int]], count: int, held_out: float) -> Blocks:
    """Cut each of ``stretches`` into ``count`` blocks and hold out that share of them, evenly spaced.

    Neighbouring training blocks are joined.
    """
    away = max(1, round(held_out * count))
    chosen = {int((k + 0.5) * count / away) for k in range(away)}
    train: list[tuple[int, int]] = []
    kept: list[tuple[int, int]] = []
    for first, end in stretches:
        edges = np.linspace(first, end, count + 1).astype(int)
        open_run: int | None = None
        for k in range(count):
            if k in chosen:
                kept.append((int(edges[k]), int(edges[k + 1])))
                if open_run is not None:
                    train.append((open_run, int(edges[k])))
                open_run = None
            elif open_run is None:
                open_run = int(edges[k])
        if open_run is not None:
            train.append((open_run, end))
    return Blocks(tuple(train), tuple(kept))
