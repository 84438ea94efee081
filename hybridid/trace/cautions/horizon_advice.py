"""Which other horizons may show what a trace leaves unexplained."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from hybridid.advice.horizon import GROWS, RESOLVED, TOLERATED, slowest_time
from hybridid.naming import counted, listed
from hybridid.trace.horizons.split import FEWEST, Split
from hybridid.trace.refits.refitted import Refit
from hybridid.trace.search.longer import MOSTLY_NOISE
from hybridid.trace.starts.shorter import SHARE
from hybridid.validation.drift import growth

ABSORBED = 0.2
"""Initial states that a horizon estimates, over its measured values, from which these may hide an effect."""
MANY_MORE = 1.5
"""Times the horizons that judge, from which as many more are worth another trace."""
PARTS_OF_ALL = "trace.records=null trace.held_out=null"
"""Words of a command with which parts of every record are fitted, and other parts judge."""


def other_horizons_advised(final: Refit, split: Split, noise: NDArray[np.float64]) -> str:
    """That a trace over longer or shorter horizons may show more, in words; else empty. ``noise`` (n_y,) are
    the standard deviations of the sensors' noise.

    Over longer ones, where a state of the plant is shown by no output: it is estimated anew for each horizon.
    Else over shorter ones, where the fit of the last model differs over them. Where that fit leaves mostly
    noise, it differs by that, and the shorter horizons show nothing.
    """
    hidden = [state.name for state in final.model.plant.states if state.observed_by is None]
    dt = split.records[0].dt
    if hidden:
        longest = split.horizon * min(len(split.fitted), len(split.held_out)) // FEWEST
        if longest < 2 * split.horizon:
            return ""
        return (
            f" No output shows {listed(hidden)}: estimated anew for each horizon, it may stand for what is "
            f"missing. Longer horizons may show more (trace.horizon, at most {_short(longest * dt)})."
        )
    if final.shorter is None or bool((final.shorter.score.rmse <= MOSTLY_NOISE * noise).all()):
        return ""
    shorter = split.horizon // SHARE * dt
    seconds, slowest = _short(shorter), _slowest(final, split)
    slow = f", but not of what acts as slowly as {_short(slowest)} s" if slowest > TOLERATED * shorter else ""
    return (
        f" Over horizons of {seconds} s the fit has other parameters: what is missing bends it over longer "
        f"ones. trace.horizon={seconds} may show more{slow}."
    )


def few_samples(final: Refit, split: Split) -> str:
    """That each horizon has few measured values for the initial states that it estimates, in words; else
    empty."""
    own = int(final.problem(split).moving[0].sum())
    values = split.horizon * len(final.model.outputs)
    if own <= ABSORBED * values:
        return ""
    few = counted(values, "measured value")
    return (
        f" Beware: each horizon estimates {counted(own, 'initial state')} of its own from {few}. What is "
        "missing may hide there. A longer trace.horizon shows more."
    )


def slower_dynamics(final: Refit, split: Split) -> str:
    """That the horizons are shorter than the slowest dynamics of the last model that the records resolve, in
    words; else empty. Each has an initial state of its own, which is fitted. Over longer ones a model that is
    unstable shows disturbances alone."""
    seconds, slowest = split.horizon * split.records[0].dt, _slowest(final, split)
    rate = growth(final.model, final.model.values(final.values), split.records)
    if slowest <= TOLERATED * seconds or rate * TOLERATED * seconds > GROWS:
        return ""
    return (
        f" Beware: the horizons of {_short(seconds)} s are shorter than the slowest dynamics that the "
        f"records resolve ({_short(slowest)} s). What acts as slowly may hide in their initial states. A "
        "longer trace.horizon shows it, where the records give enough of them."
    )


def _slowest(final: Refit, split: Split) -> float:
    """The slowest dynamics [s] of the last model that the records resolve; 0 where there are none."""
    longest = RESOLVED * min(float(record.time[-1] - record.time[0]) for record in split.records)
    return slowest_time(final.model, final.values, split.records, longest)


def parts_of_all_advised(split: Split) -> str:
    """That parts of every record judge better than a short record alone, in words; empty where as many
    horizons judge already."""
    judging, every = len(split.held_out), len(split.fitted) + len(split.held_out)
    if split.gap or every < MANY_MORE * 2 * judging:
        return ""
    return (
        f" Only {counted(judging, 'horizon')} judge. With {PARTS_OF_ALL} parts of "
        "every record do, more or longer ones, which may decide more."
    )


def determining_parts_advised(split: Split) -> str:
    """That parts of every record may determine the parameters, in words; empty where they are fitted
    already."""
    if split.gap:
        return ""
    return (
        f" With {PARTS_OF_ALL} parts of every record are fitted, which may determine "
        "them; a record that moves in more ways does."
    )


def _short(seconds: float) -> str:
    """Two digits, no power of ten: ``0.1``, ``68``, ``1000``."""
    return f"{float(f'{seconds:.2g}'):g}"
