"""Effects with fewer parameters in the place of those that a search accepted.

A forward search takes what explains most beside the model of its step. While a second effect is still
missing, an effect of two parameters that bends to both explains more than either: an eddy-current brake or a
Stribeck peak for Coulomb friction beside a drag. Once the drag is in the model, one parameter does. So each
accepted effect is exchanged for effects of fewer parameters at its port, as long as one of them is as good.

Source: sequential replacement; Miller (2002), Subset Selection in Regression, 2nd ed., Chapman & Hall, ch. 3.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

from hybridid.trace.candidates import Candidate
from hybridid.trace.context import Context
from hybridid.trace.refits.refit import refit_if_possible
from hybridid.trace.refits.refitted import Refit, values_without
from hybridid.trace.search.steps import Accepted, Search, Step
from hybridid.trace.trials.trial import Trial
from hybridid.trace.trials.tried import tried_in_place

AsGood = Callable[[Refit, Refit], bool]


def simplified(found: Search, as_good: AsGood, context: Context) -> Search:
    """``found`` with simpler effects in the place of accepted ones, each ``as_good`` (the refit with it, the
    last one) as what it replaces. A step holds what was tried in the place of each."""
    several = [one for one in found.accepted if one.trial.free_parameters > 1]
    for one in sorted(several, key=lambda one: -one.trial.free_parameters):
        trials = _simpler(found, one, context)
        found = replace(found, steps=(*found.steps, Step(found.final, tuple(trials), None)))
        good = [t for t in trials if t.refit and as_good(t.refit, found.final)]
        if good:
            best = min(good, key=lambda t: (t.free_parameters, -t.gain))
            return simplified(_with(found, one, best), as_good, context)
    return found


def _simpler(found: Search, one: Accepted, context: Context) -> list[Trial]:
    """The trials of effects with fewer parameters in the place of ``one``, at its port."""
    final = found.final
    model, values = final.model.without(one.name), values_without(final, one.name)

    def is_simpler(other: Candidate) -> bool:
        at_its_port = other.port == one.trial.candidate.port
        return at_its_port and other.free_parameters < one.trial.free_parameters

    rivals = [other for other in context.candidates(model) if is_simpler(other)]
    poorer = context.one(refit_if_possible, model, context.split, [values], final, final.numerics, math.inf)
    return tried_in_place(one.name, rivals, poorer, final, context) if poorer is not None else []


def _with(found: Search, one: Accepted, best: Trial) -> Search:
    """``found`` with ``best`` in the place of the accepted ``one``."""
    assert best.refit is not None
    instead = Accepted(best, (best,), ())
    accepted = tuple(instead if other is one else other for other in found.accepted)
    return replace(found, final=best.refit, accepted=accepted)
