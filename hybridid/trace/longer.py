"""Whether a model that meets the noise over short horizons does so over longer ones, too.

The initial state of each horizon is fitted. What a missing effort does to the motion grows from there on:
over a horizon of a few samples it may stay within the noise, whatever is missing. A complete model leaves the
noise over horizons of any length, if its parameters are fitted over these. So before nothing is said to be
missing, the last model is fitted and judged over longer horizons, up to ten times as long, of which enough
are left on either side.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

from hybridid.trace.accuracy import Accuracy
from hybridid.trace.context import Context
from hybridid.trace.refit import Refit, refit_if_possible
from hybridid.trace.split import Split

LEAST = 20
"""Samples of a horizon below which its fitted initial state may follow what a missing effort does."""
TIMES = (10.0, 5.0, 3.0, 2.0)
"""How much longer the horizons are: the first for which enough are left."""


@dataclass(frozen=True)
class Longer:
    """Over horizons of ``seconds`` a model leaves ``times`` what noise and simulation alone leave."""

    seconds: float
    times: float


def more_over_longer(final: Refit, context: Context) -> Longer | None:
    """What ``final`` leaves over longer horizons, if that is more than ``Rules.far`` times what noise and
    simulation alone leave there; None also where longer horizons are too few, or cannot be simulated."""
    split = _longer(context.split)
    if split is None:
        return None
    there = replace(context, split=split)
    found = there.one(refit_if_possible, final.model, split, [final.values], None, final.numerics)
    if found is None:
        return None
    times = Accuracy.of(found, there).times(found.score.rmse)
    if times <= context.rules.far:
        return None
    return Longer(split.horizon * split.records[0].dt, times)


def shows_little(split: Split) -> bool:
    """Whether horizons are so short that they show little, and the records give no longer ones."""
    return split.horizon < LEAST and _longer(split) is None


def _longer(split: Split) -> Split | None:
    for times in TIMES:
        try:
            return split.longer(int(times * split.horizon))
        except ValueError:  # too few horizons
            continue
    return None
