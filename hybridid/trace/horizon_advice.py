"""Which other horizons may show what a trace leaves unexplained."""

from __future__ import annotations

from hybridid.naming import listed
from hybridid.trace.refit import Refit
from hybridid.trace.shorter import SHARE
from hybridid.trace.split import FEWEST, Split


def other_horizons_advised(final: Refit, split: Split) -> str:
    """That a trace over longer or shorter horizons may show more, in words; else empty.

    Over longer ones, where a state of the plant is shown by no output: it is estimated anew for each horizon.
    Else over shorter ones, where the fit of the last model differs over them.
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
    if final.shorter is None:
        return ""
    seconds = _short(split.horizon // SHARE * dt)
    return (
        f" Over horizons of {seconds} s the fit has other parameters: what is missing bends it over longer "
        f"ones. trace.horizon={seconds} may show more."
    )


def _short(seconds: float) -> str:
    """Two digits, no power of ten: ``0.1``, ``68``, ``1000``."""
    return f"{float(f'{seconds:.2g}'):g}"
