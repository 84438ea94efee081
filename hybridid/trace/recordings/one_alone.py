"""Whether one parameter, or one gauge, that is another in the recordings that judge explains them alone.

A gauge or an amplifier whose range was changed between two recordings scales an input or an output. Then
every parameter that carries the effort seems to differ, all by one factor. So the gain of each input and the
scale of each output is fitted alone to the recordings that judge, with all else as the others have it; and so
is each parameter that seems to differ. A payload that was changed is one such parameter. A gauge is told only
where it takes more than each parameter does, by more than ``Rules.tie``.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from hybridid.model import Model
from hybridid.quantities import estimated, share
from hybridid.trace.context import Context
from hybridid.trace.horizons.split import Split
from hybridid.trace.recordings.gauges import error_of, gauges, is_error_of_gauge, put_right
from hybridid.trace.refits.refit import refit_if_possible
from hybridid.trace.refits.refitted import Refit
from hybridid.trace.trials.constancy import with_smoothing


@dataclass(frozen=True)
class _Alone:
    """The parameter ``name`` alone, fitted to the recordings that judge, which leaves the share ``left`` of
    the RMSE there."""

    name: str
    refit: Refit
    left: float


def one_alone(final: Refit, moved: list[str], context: Context) -> str:
    """Which one of the parameters ``moved``, or which gauge, alone takes most of the squared error of
    ``final`` from the recordings that judge, in words; empty if none does."""
    places = [(name, final.model, final, context.split) for name in moved]
    places += [
        (error_of(one), one.added_to(final.model), final, context.split) for one in gauges(final.model)
    ]
    tried = context.each("one parameter in the recordings that judge", _fitted_alone, places)
    found = [one for one in tried if one is not None and 1.0 - one.left**2 >= context.rules.majority]
    if not found:
        return ""
    best = min(found, key=lambda one: one.left)
    enough = best.left / (1.0 - context.rules.tie)
    plain = [one for one in found if not is_error_of_gauge(one.name) and one.left <= enough]
    return _in_words(min(plain, key=lambda one: one.left, default=best))


def _fitted_alone(name: str, model: Model, final: Refit, split: Split) -> _Alone | None:
    """The parameter ``name`` of ``model``, fitted to the horizons that judge ``final``, all others as
    ``final`` has them; None if it cannot be."""
    known = {p.name: {"fixed": final.values[p.name]} for p in final.model.free if p.name != name}
    model = replace(model, adjustments={**model.adjustments, **known})
    values = {name: 0.0, **final.values}
    there = refit_if_possible(model, split.swapped, [values], final, final.numerics, math.inf)
    if there is None or not there.converged or not final.score.loss > 0:
        return None
    left = math.sqrt(float(np.mean((there.fitted_rmse / final.score.scale) ** 2))) / final.score.loss
    return _Alone(name, with_smoothing(there, split.swapped), left)


def _in_words(one: _Alone) -> str:
    (free,) = one.refit.model.free
    value = estimated(one.refit.values[one.name], one.refit.std.get(one.name), free.unit)
    takes = share(1.0 - one.left**2)
    if not is_error_of_gauge(one.name):
        return f" There {one.name} alone ({one.name.rsplit('.', 1)[-1]} = {value}) takes {takes}."
    gauge, name = one.name.rsplit(".", 1)
    return (
        f" There {gauge} alone ({name} = {value}) takes {takes}: a gauge or an amplifier may have another "
        f"range, which {put_right(one.name, one.refit.values[one.name])} puts right."
    )
