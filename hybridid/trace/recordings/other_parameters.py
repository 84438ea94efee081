"""Whether the same equations with other parameters explain the recordings that judge.

A complete model, whose parameters are the same in every recording, leaves about as much where it is judged as
a fit to these horizons alone would leave. If that fit takes most of the squared error there
(``Rules.majority``), and parameters a +- s where the trace fits end at a' +- s' there,

    2 n (1 - Phi(|a - a'| / sqrt(s^2 + s'^2))) <= alpha,

of n parameters, then a parameter differs between the recordings, or each fit makes up for a missing effect in
its own way. The standard errors are those of coloured residuals. Both fits must have converged.

Source: Chow (1960), Tests of equality between sets of coefficients in two linear regressions, Econometrica
28(3), 591-605.
"""

from __future__ import annotations

import math

import numpy as np

from hybridid.naming import listed
from hybridid.quantities import share
from hybridid.records.record import Record
from hybridid.trace.context import Context
from hybridid.trace.horizons.split import Split
from hybridid.trace.recordings.one_alone import one_alone
from hybridid.trace.refits.refit import refit_if_possible
from hybridid.trace.refits.refitted import Refit
from hybridid.trace.trials.constancy import Amplitude, fitted_to_held_out

TOLD = 3
"""Parameters that are told, at most."""
ASK = (
    " To ask which parameter differs between the recordings: trace.by_recording=true trace.records=null "
    "trace.held_out=null."
)


def recordings(records: tuple[Record, ...] | list[Record]) -> set[str]:
    """The recordings that ``records`` are of: parts of one file are one recording."""
    return {record.digest or record.name for record in records}


def other_parameters(final: Refit, context: Context) -> str:
    """How much a fit of ``final``'s model to the recordings that judge takes there, and which parameters it
    moves, in words; empty if it takes less than most, moves none for certain, or a recording is on both
    sides."""
    split, rules = context.split, context.rules
    if not recordings(split.fitted_records).isdisjoint(recordings(split.swapped.fitted_records)):
        return ""
    (there,) = fitted_to_held_out([final], context)
    here = _with_std(final, split)
    if here is None or there is None or not (there.converged and final.converged):
        return ""
    left = float(np.mean((there.fitted_rmse / final.score.scale) ** 2))
    taken = 1.0 - left / final.score.loss**2 if final.score.loss > 0 else 0.0
    moved = _moved(here, there, rules.alpha)
    if taken < rules.majority or not moved:
        return ""
    told = listed([str(one) for one in moved[:TOLD]])
    alone = one_alone(final, [one.name for one in moved], context)
    return (
        f" Fitted to the recordings that judge alone, the same model leaves {share(taken)} less of the "
        f"squared error there, with {told}.{alone} A parameter may differ between the "
        f"recordings, or each fit makes up for a missing effect in its own way.{ASK}"
    )


def _with_std(final: Refit, split: Split) -> Refit | None:
    """``final`` with standard errors: the search does not compute those of every model."""
    if final.std:
        return final
    return refit_if_possible(final.model, split, [final.values], final, final.numerics, math.inf)


def _moved(here: Refit, there: Refit, alpha: float) -> list[Amplitude]:
    """The parameters that certainly end elsewhere ``there``, the most certain one first."""
    every = [
        Amplitude(
            p.name,
            p.unit,
            (here.values[p.name], here.std.get(p.name, math.nan)),
            (there.values[p.name], there.std.get(p.name, math.nan)),
            min(abs(here.values[p.name]), abs(there.values[p.name])),
        )
        for p in here.model.free
    ]
    return sorted((one for one in every if len(every) * one.p_value <= alpha), key=lambda one: one.p_value)
