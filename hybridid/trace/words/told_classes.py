"""The members of a class as they are told: with the values that they have in the last model.

A trial is judged in its step, by the standard errors of the noise alone. The last fit, by which an accepted
effect is told, holds what was accepted later, and its standard errors have the share of the smoothing of
sign(v) as well. So each other member takes the place of the accepted one in the last model, and gets that
share, too: else their values could not be compared. The last model holds all that the step's does; so where
a refit there leaves more than the member did in its step, the descent went astray, and the step's counts.
What else is told may depend on the member: the parameters that leave their intervals are told with it.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

from hybridid.estimators.one_start import SETTLED
from hybridid.naming import listed
from hybridid.quantities import Z95, quantity
from hybridid.trace.context import Context
from hybridid.trace.horizons.split import Split
from hybridid.trace.refits.refitted import Refit
from hybridid.trace.results.result import Trace
from hybridid.trace.search.steps import Accepted, Search
from hybridid.trace.trials.constancy import with_smoothing
from hybridid.trace.trials.exchange import exchanged
from hybridid.trace.trials.trial import Trial

FEW, DIGITS = 3, 4
"""Parameters that are told to depend on the member, those that move most, and their digits."""


def as_told(found: Search, context: Context) -> tuple[Accepted, ...]:
    """What ``found`` accepted, the members of whose classes are as its last model has them."""
    members = [(one, t) for one in found.accepted if len(one.alike) > 1 for t in one.alike]
    known = {(one.name, t.candidate.name): (one, t) for one, t in members if t.refit and t.refit.std}
    given = [(found.final, one, t, context.split) for one, t in known.values()]
    told = dict(zip(known, context.each("members of a class", _in_the_last_model, given), strict=True))

    def told_of(one: Accepted, member: Trial) -> Trial:
        return replace(member, refit=told.get((one.name, member.candidate.name), member.refit))

    return tuple(replace(one, alike=tuple(told_of(one, t) for t in one.alike)) for one in found.accepted)


def _in_the_last_model(final: Refit, one: Accepted, member: Trial, split: Split) -> Refit:
    """``member`` in the place of ``one`` in the model ``final``, with the share of the smoothing in its
    standard errors; as in its step where that model is the same, cannot be simulated, or leaves more."""
    assert member.refit is not None
    assert one.trial.refit is not None
    here = member.refit
    if final.model != one.trial.refit.model:
        its = member is one.trial
        there = final if its else exchanged(final, one.name, member.candidate, split, here.values)
        if there is not None and there.cost <= (1 + SETTLED) * here.cost:
            here = replace(there, std=here.std)
    return with_smoothing(here, split)


def depends_on_the_member(accepted: Sequence[Accepted], traced: Trace) -> str:
    """Which parameters leave their intervals with another member of a class, in words; else empty.
    ``accepted`` are as told."""
    return "".join(
        f" Beware: other parameters depend on which of the class of {one.name} it is: {moved}."
        for one in accepted
        if (moved := _moved(one, traced))
    )


def _moved(one: Accepted, traced: Trace) -> str:
    """The parameters that leave the intervals of the last fit with a member of the class of ``one``, those
    that move most, each from the least to the largest that it may be, in words."""
    members = [t.refit for t in one.alike if t.candidate.name != one.name and t.refit is not None]
    every = {
        p.name: [m.values[p.name] for m in members if p.name in m.std] for p in traced.estimate.parameters
    }
    known = [p for p in traced.estimate.parameters if p.identifiable and math.isfinite(p.std) and p.std > 0]
    far = {p.name: max((abs(v - p.value) / p.std for v in every[p.name]), default=0.0) for p in known}
    most = sorted((p for p in known if far[p.name] > Z95), key=lambda p: -far[p.name])
    ranges = {
        p.name: [quantity(end([p.value, *every[p.name]]), p.unit, DIGITS) for end in (min, max)] for p in most
    }
    told = [f"{name} is between {low} and {high}" for name, (low, high) in ranges.items() if low != high]
    return listed(told[:FEW]) if told else ""
