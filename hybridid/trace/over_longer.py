"""What a model lacks over horizons that are long enough: the search goes on over longer ones.

Over short horizons the fitted initial state hides what adds up slowly. Where the declared model meets the
noise over them, and leaves more over longer ones, the search begins over the longer ones
(``hybridid.trace.search.longer.over_long_enough``). Where nothing was found over the short ones, and longer
ones leave more, it begins anew over these. So it does where what was accepted meets the noise over the short
ones alone: a large effect shows over any horizon, and a slow one beside it over long ones alone. Then the
second conclusion counts if it holds each name of the first, and more.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

from hybridid.model import Model
from hybridid.settings.choices import AskedIntegrator
from hybridid.trace.context import Context
from hybridid.trace.refits.declared_starts import declared_starts
from hybridid.trace.refits.numerics import numerics_for
from hybridid.trace.search.longer import (
    MOSTLY_NOISE,
    Longer,
    lengthened,
    made_by_noise,
    more_over_longer,
    over_long_enough,
    worth_looking_for,
)
from hybridid.trace.search.steps import Accepted
from hybridid.trace.verdict import Conclusion, conclude


def concluded(
    model: Model,
    context: Context,
    start: Sequence[Mapping[str, float]],
    integrator: AskedIntegrator,
    may_lengthen: bool,
) -> tuple[Conclusion, Context]:
    """What is found on the horizons of ``context``, or on longer ones if these show more and it may. Where
    noise of an input may make all that is left, more over longer horizons shows nothing: it adds up there."""
    if not may_lengthen:
        return conclude(model, context, start, integrator), context
    starts = declared_starts(model, context.split, start)
    numerics = numerics_for(model, context.split, starts, integrator)
    context = over_long_enough(model, context, starts, numerics)
    found = conclude(model, context, start, integrator)
    if found.noisy or context.out_of_time:
        return found, context
    longer = found.longer or _beside_accepted(found, context)
    if longer is None or not longer.judged:
        return found, context
    there = lengthened(context, longer)
    again = conclude(model, there, start, integrator)
    if found.accepted and not _holds_more(again.accepted, found.accepted):
        context.say("over the longer horizons no more is named: what was found over the shorter ones is told")
        return replace(found, grows=longer), context
    return again, there


def _beside_accepted(found: Conclusion, context: Context) -> Longer | None:
    """What the last model leaves over longer horizons, if what was accepted meets the noise over these, and a
    complete model could take what is worth having there."""
    if not found.accepted or found.times > MOSTLY_NOISE:
        return None
    final = found.search.final
    longer = more_over_longer(final, context, worth_looking_for(context.rules))
    if longer and longer.judged and made_by_noise(longer, final, context):
        return None
    return longer


def _holds_more(found: Sequence[Accepted], before: Sequence[Accepted]) -> bool:
    """Whether ``found`` is more than what was accepted ``before``, each of which it holds by its name or in
    its class."""
    classes = [{one.name, *(trial.candidate.name for trial in one.alike)} for one in found]
    return len(found) > len(before) and all(any(one.name in names for names in classes) for one in before)
