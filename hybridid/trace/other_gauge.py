"""Whether one gauge that reads otherwise in the recordings that judge explains what other parameters would.

A gauge or an amplifier whose range was changed between two recordings scales an input or an output. Then
every parameter that carries the effort seems to differ, all by one factor. So the gain of each input and the
scale of each output is fitted alone to the recordings that judge, with all else as the others have it.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from hybridid.quantities import estimated, share
from hybridid.trace.candidates import Candidate
from hybridid.trace.constancy import with_smoothing
from hybridid.trace.context import Context
from hybridid.trace.gauges import error_of, gauges, put_right
from hybridid.trace.refit import Refit, refit_if_possible
from hybridid.trace.split import Split


def other_gauge(final: Refit, context: Context) -> str:
    """Which gauge alone takes most of the squared error of ``final`` from the recordings that judge, in
    words; empty if none does."""
    every = list(gauges(final.model))
    tried = context.each(
        "one gauge in the recordings that judge", _read, [(one, final, context.split) for one in every]
    )
    left = final.score.loss**2
    taken = {
        1.0 - float(np.mean((there.fitted_rmse / final.score.scale) ** 2)) / left: (one, there)
        for one, there in zip(every, tried, strict=True)
        if there is not None and there.converged and left > 0
    }
    most = max(taken, default=0.0)
    if most < context.rules.majority:
        return ""
    one, there = taken[most]
    (factor,) = there.model.free
    name = factor.name.rsplit(".", 1)[-1]
    value = estimated(there.values[factor.name], there.std.get(factor.name), "")
    return (
        f" There {one.name} alone ({name} = {value}) takes {share(most)}: a gauge or an amplifier may have "
        f"another range, which {put_right(factor.name, there.values[factor.name])} puts right."
    )


def _read(gauge: Candidate, final: Refit, split: Split) -> Refit | None:
    """The factor of ``gauge`` alone, fitted to the horizons that judge ``final``; None if it cannot be."""
    known = {p.name: {"fixed": final.values[p.name]} for p in final.model.free}
    richer = gauge.added_to(final.model)
    model = replace(richer, adjustments={**richer.adjustments, **known})
    values = {**final.values, error_of(gauge): 0.0}
    found = refit_if_possible(model, split.swapped, [values], final, final.numerics, math.inf)
    return found and with_smoothing(found, split.swapped)
