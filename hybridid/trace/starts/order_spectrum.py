"""Pitches of what repeats along the way, from the spectrum of the missing effort over position.

A motor of many poles turns through hundreds of pitches in one record. No grid of pitches is fine enough
there: two of them are told apart by half a period over the whole way. So the missing effort
(``hybridid.trace.ports.missing_effort``) is summed in bins of position, and its Fourier transform shows a
line at each pitch (order analysis). Records have no common origin of position, so their powers are added.
Noise alone has a power that is distributed exponentially about its median; only what stands out of that is a
line.

Source: Brandt (2011), Noise and Vibration Analysis, Wiley, ch. 12 (order tracking); Fisher (1929), Tests of
significance in harmonic analysis, Proc. R. Soc. A 125, 54-59.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import median_filter

from hybridid.simulation.windows import cut
from hybridid.trace.horizons.split import Split
from hybridid.trace.ports.missing_effort import missing_effort
from hybridid.trace.refits.refit import FAILURES
from hybridid.trace.refits.refitted import Refit

Array = NDArray[np.float64]
LINES = 3
"""Strongest lines that are returned."""
CHANCE = 0.01
"""Probability that noise alone shows a line anywhere."""
NEIGHBOURS = 201
"""Orders whose median is the power without a line."""
MOST_BINS = 2**16


def pitches(base: Refit, split: Split, port: str, periods: float) -> list[float]:
    """Pitches at the effort ``port`` of which more than ``periods`` lie in the visited range, the strongest
    line first, each with half a period over that range to either side; none where no line stands out, or no
    effort can be estimated. The fitted horizons alone decide."""
    key = ("pitches", port, tuple(base.values.values()), split.fitted, split.horizon, periods)
    return base.model.kept(key, lambda: _pitches(base, split, port, periods))


def _pitches(base: Refit, split: Split, port: str, periods: float) -> list[float]:
    try:
        seen = _along_position(base, split, port)
    except (ValueError, *FAILURES):
        return []
    where = np.concatenate([position for position, _ in seen])
    low, span = float(where.min()), float(np.ptp(where))
    steps = np.abs(np.concatenate([np.diff(position) for position, _ in seen]))
    if span <= 0 or not (steps > 0).any():
        return []
    bins = int(min(MOST_BINS, span / np.median(steps[steps > 0])))
    power = np.zeros(bins + 1)
    for position, effort in seen:
        place = np.minimum((position - low) / span * bins, bins - 1).astype(int)
        power += np.abs(np.fft.rfft(np.bincount(place, effort, bins), 2 * bins)) ** 2
    orders = lines(power, round(2 * periods))
    return [span / (half / 2 + beside) for half in orders for beside in (-0.25, 0.0, 0.25)]


def lines(power: Array, first: int) -> list[int]:
    """Numbers of the strongest lines in ``power`` (n,) beyond the number ``first``, the strongest first.

    A line is higher than h medians, where noise alone is so with a probability of ``CHANCE`` / n. The median
    of m neighbours scatters about ln 2 with a variance of 1/m, so ``exp(-h ln 2 + h²/(2 m)) = CHANCE / n``.
    """
    if len(power) <= first + NEIGHBOURS:
        return []
    around = median_filter(power, NEIGHBOURS, mode="reflect")
    height = np.divide(power, around, out=np.zeros_like(power), where=around > 0)
    height[: first + 1] = 0.0
    rare, m = np.log(len(power) / CHANCE), NEIGHBOURS
    least = m * (np.log(2) - np.sqrt(np.log(2) ** 2 - 2 * rare / m))
    peaks = np.flatnonzero((height[1:-1] > height[:-2]) & (height[1:-1] >= height[2:])) + 1
    high = sorted((k for k in peaks.tolist() if height[k] > least), key=lambda k: -power[k])
    return high[:LINES]


def _along_position(base: Refit, split: Split, port: str) -> list[tuple[Array, Array]]:
    """Position and missing effort, less its mean, at the fitted samples of each record."""
    origins = cut(split.records, split.horizon, 1).origin
    found = []
    for number in sorted({origins[k][0] for k in split.fitted}):
        record = split.records[number]
        missing = missing_effort(base.model, base.values, record, port)
        kept = np.zeros(record.n, dtype=bool)
        for k in split.fitted:
            if origins[k][0] == number:
                kept[origins[k][1] : origins[k][2] - split.gap] = True
        kept = kept[missing.rows] if missing.rows is not None else kept
        effort = missing.effort[kept]
        found.append((missing.motion["position"][0][kept], effort - effort.mean()))
    return found
