"""Whether the error that is left grows with the length of a horizon.

The initial state of each horizon is fitted. What a missing effort does to the motion grows from there on:
over a short horizon it is small. The noise of a sensor is as large over any horizon. If it has a memory (a
filter, waves on a tank), it is larger than what the records show from sample to sample. So where the error is
as large over horizons a tenth as long, and no variable explains any of it, the records do not decide: it may
be such a noise, another error of the sensor, or an effect that is faster than the short horizons.

Source: Ljung (1999), System Identification, 2nd ed., sec. 3.2 (coloured noise).
"""

from __future__ import annotations

import numpy as np

from hybridid.trace.context import Context
from hybridid.trace.refits.refitted import Refit
from hybridid.trace.starts.shorter import SHARE, over_shorter

STEADY = 1.5
"""Largest ratio of the errors over long and short horizons: a fitted initial state takes up a part of a noise
with a memory. What a constant missing effort does to a velocity grows tenfold, to a position more."""


def steady_over(final: Refit, context: Context) -> float | None:
    """The length [s] of shorter horizons over which every output errs as much as over those of the trace;
    None where one errs less, or they cannot be simulated."""
    found = context.one(over_shorter, final, context.split)
    if found is None or not np.all(final.score.rmse <= STEADY * found.score.rmse):
        return None
    return context.split.horizon // SHARE * context.split.records[0].dt
