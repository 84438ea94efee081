"""Clipping: a signal reaches a limit abruptly, stays exactly there, and leaves it abruptly."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from hybridid.records.channel import Array

MINIMUM_RUN = 3  # samples; the peak of a coarsely quantised signal may repeat once
RUN_RATIO = 3.0  # how much longer than a signal's usual runs of equal values
SLOPE_RATIO = 0.1  # of the signal's usual slope; with less, the signal came to rest by itself
MISSING_QUANTA = 4.0  # height of the part that was cut off, in steps of the signal's resolution
VICINITY = 10  # samples before and after a run in which the signal must be moving


def clipped_runs(values: Array) -> list[tuple[int, int]]:
    """Where ``values`` (n,) looks clipped: half-open sample ranges, in order.

    A run of equal values at the signal's maximum or minimum counts as clipped if

    - it is much longer than the signal's other runs (a two-level command, a staircase or a
      slow encoder has long runs everywhere),
    - the signal moves at its usual rate directly before *and* after it (a machine that comes to
      rest at its end of travel slows down before),
    - straight lines with the slopes before and after it would meet well beyond the limit, in units
      of the signal's resolution (the top of a coarsely quantised wave is flat but complete),
    - and it is not a rest: its value is not zero and not that of the record's first or last sample.

    An intended trapezoid meets all four conditions; the text of the warning allows for it.
    """
    steps = np.abs(np.diff(values))
    if not steps.any():
        return []
    edges = np.concatenate(([0], np.flatnonzero(steps) + 1, [len(values)]))
    starts, lengths, levels = edges[:-1], np.diff(edges), values[edges[:-1]]
    extreme = (levels == values.max()) | (levels == values.min())
    if extreme.all():
        return []  # only two levels: a limit cannot be told from them
    shortest = max(MINIMUM_RUN, RUN_RATIO * float(np.percentile(lengths[~extreme], 95)))
    at_rest = (levels == 0) | (levels == values[0]) | (levels == values[-1])
    moving = len(values) - int(lengths[lengths >= shortest].sum())
    usual = float(steps.sum()) / max(moving, 1)
    quantum = float(steps[steps > 0].min())
    candidates = np.flatnonzero(extreme & ~at_rest & (lengths >= shortest))
    runs = [(int(starts[i]), int(lengths[i])) for i in candidates]
    return [
        (start, start + length)
        for start, length in runs
        if (slope := min(_slopes(values, steps, quantum, start, length))) >= SLOPE_RATIO * usual
        # lines of slopes +s and -s over a base of `length` samples meet at s * length / 2
        and slope * length / 2 >= MISSING_QUANTA * quantum
    ]


def _slopes(values: Array, steps: Array, quantum: float, start: int, length: int) -> Iterator[float]:
    """Slopes (per sample) on both sides of a run, near and far.

    The near slope is the path length, so that noise counts as motion, minus one step of the resolution,
    so that a single last count does not. The far slope is the difference over half the length of the
    run, a distance over which a smooth top would hardly have curved.
    """
    last, reach = start + length - 1, max(2, length // 2)
    for path in (steps[max(start - VICINITY, 0) : start], steps[last : last + VICINITY]):
        yield max(float(path.sum()) - quantum, 0.0) / VICINITY
    for far in (max(start - reach, 0), min(last + reach, len(values) - 1)):
        yield abs(float(values[start] - values[far])) / reach
