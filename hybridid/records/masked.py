"""Parts of a record that do not count: their samples stay on the time axis, but no error there is taken."""

from __future__ import annotations

from collections.abc import Iterable
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Counts = NDArray[np.bool_]
Cells = NDArray[np.bool_]
Levels = NDArray[np.int8]
COUNTS, THROUGH, APART = 0, 1, 2
"""What a sample is: it counts, it is masked and simulated through, it is masked and not simulated."""


class Masked(NamedTuple):
    """Samples ``first`` to ``end`` (exclusive) do not count.

    ``through``: the simulation runs through them, with the recorded inputs. False: it ends before them and
    starts anew after them.
    """

    first: int
    end: int
    through: bool = True


def levels_of(masked: Iterable[Masked], n: int) -> Levels:
    """``COUNTS``, ``THROUGH`` or ``APART`` of each of ``n`` samples, (n,)."""
    found = np.zeros(n, dtype=np.int8)
    for first, end, through in masked:
        found[first:end] = np.maximum(found[first:end], THROUGH if through else APART)
    return found


def masked_of(levels: Levels) -> tuple[Masked, ...]:
    """The masked stretches of ``levels`` (n,), in order."""
    return tuple(
        Masked(first, end, bool(levels[first] == THROUGH)) for first, end in runs(levels) if levels[first]
    )


def runs(values: NDArray[np.int8] | Counts) -> list[tuple[int, int]]:
    """First and end sample of each stretch of equal ``values`` (n,), in order."""
    edges = [0, *(np.flatnonzero(np.diff(values)) + 1).tolist(), len(values)]
    return list(pairwise(edges)) if len(values) else []


def pieces(counts: Counts) -> list[tuple[int, int]]:
    """First and end sample of each stretch of samples that count, in order."""
    return [(first, end) for first, end in runs(counts) if counts[first]]
