"""Which members of a class the records refute where the last model meets the noise.

Beside a model that lacks something, two effects are one class if one leaves less by ``Rules.tie``: what else
is missing may make that difference. A model that meets the noise lacks nothing. There any misfit of a member
is a small share of the error, though the likelihood may exclude it. So a member leaves its class if the
accepted effect, in its place, leaves significantly less error, with all members counted, and less on the
fitted horizons as well. The difference of the squared errors must be ``MORE`` times what either simulation
errs by, and stay where sign(v) is smoothed more narrowly.

Source: Vuong (1989), Econometrica 57(2), 307-333 (likelihood ratios of models that are not nested).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from hybridid.trace.context import Context
from hybridid.trace.horizons.evidence import compare
from hybridid.trace.noise_floor.accuracy import simulation_error
from hybridid.trace.refits.refitted import Refit
from hybridid.trace.search.steps import Accepted, Search
from hybridid.trace.trials.exchange import exchanged
from hybridid.trace.trials.smoothed_apart import smoothed_apart
from hybridid.trace.trials.trial import Trial

MORE = 4.0
"""Times the squared error of the simulation that a difference must be, to be the machine's."""


def without_refuted(found: Search, context: Context) -> Search:
    """``found`` without the members of its classes that the records refute, if its last model meets the
    noise."""
    if not context.meets_noise(found.final.score):
        return found
    rivals = [(one, t) for one in found.accepted for t in one.alike if t is not one.trial and t.refit]
    given = [
        (found.final, one.name, t.candidate, context.split, t.refit and t.refit.values) for one, t in rivals
    ]
    others = context.each("in place of what was accepted", exchanged, given)
    gone = [
        t
        for (_, t), other in zip(rivals, others, strict=True)
        if other is not None and _refuted(other, found.final, len(rivals), context)
    ]
    return replace(found, accepted=tuple(_without(gone, one) for one in found.accepted)) if gone else found


def _without(gone: Sequence[Trial], one: Accepted) -> Accepted:
    return replace(one, alike=tuple(t for t in one.alike if not any(t is other for other in gone)))


def _refuted(other: Refit, final: Refit, counted: int, context: Context) -> bool:
    """Whether ``final`` explains more than ``other``, one of so many, by what no simulation errs."""
    advantage = compare(other.score, final.score)
    significant = advantage.gain > 0 and counted * advantage.p_value <= context.rules.alpha
    if not (significant and other.converged and other.cost > final.cost):
        return False
    more = other.score.rmse**2 - final.score.rmse**2
    errs = [simulation_error(one, context) ** 2 for one in (other, final)]
    if not bool(np.any(more > MORE * np.max(errs, axis=0))):
        return False
    return not smoothed_apart(final, other, context.split, context.rules)
