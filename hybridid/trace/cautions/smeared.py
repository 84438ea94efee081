"""Whether the smoothing of sign(v) may be all that an unexplained error is.

A machine that sticks stays where it is, and tanh(v/epsilon) lets its model creep: with half of the breakaway
force at 0.55 epsilon. The search narrows epsilon as long as that pays, and compares with half of it
(Richardson) to tell the error of the simulation. On a machine that sticks often the cost is rough, and a
refit with half of epsilon may end in a poorer valley: then the comparison says nothing. The derivative of the
outputs by epsilon needs no refit: to first order, ``epsilon dy/depsilon`` without what initial states and
parameters take up is what the smoothing leaves (``hybridid.estimators.uncertainty``).
"""

from __future__ import annotations

from hybridid.estimators.uncertainty import uncertainty
from hybridid.naming import listed
from hybridid.quantities import quantity
from hybridid.trace.context import Context
from hybridid.trace.refits.refitted import Refit

MOST = 0.5
"""Of the error left, that the smoothing makes at least where it may be all."""


def smoothing_may_be_all(final: Refit, context: Context) -> str:
    """Of which outputs the smoothing of sign(v) makes most of what ``final`` leaves on the fitted horizons;
    empty if of none."""
    fitted = list(context.split.fitted)
    problem = final.problem(context.split).on(fitted)
    if not problem.widths:
        return ""
    smeared = uncertainty(problem, final.model.values(final.values), final.x0[fitted]).smeared
    said = [
        f"{quantity(ours, y.unit, 2)} of {y.name} ({quantity(left, y.unit, 2)} is all that is left)"
        for y, ours, left in zip(final.model.outputs, smeared, final.fitted_rmse, strict=True)
        if ours >= MOST * left
    ]
    if not said:
        return ""
    widths = listed([final.model.parameters[k].name for k in problem.widths])
    return (
        f" Beware: on the fitted horizons the smoothing of sign(v) leaves to first order {listed(said)}: "
        "that the machine sticks where the model creeps may be a part of what is missing, or all. A smaller "
        f"{widths} or shorter horizons tell."
    )
