"""Why a search seeks no further effect: nothing is left, no time is left, or another one would be no name."""

from __future__ import annotations

from collections.abc import Sequence

from hybridid.trace.context import Context
from hybridid.trace.noise_floor.accuracy import Accuracy
from hybridid.trace.noise_floor.together import meets_noise_together
from hybridid.trace.refits.refitted import Refit
from hybridid.trace.search.steps import (
    AT_FLOOR,
    AT_FLOOR_TOGETHER,
    AT_SIMULATION,
    NO_ROOM,
    OUT_OF_TIME,
    RECORDINGS_DIFFER,
    Accepted,
    Step,
)
from hybridid.trace.trials.alike import strangers
from hybridid.trace.trials.exchange import still_alike


def nothing_to_seek(base: Refit, accepted: Sequence[Accepted], context: Context) -> str:
    """Why no effect is sought beside ``base``; empty if one is."""
    if context.meets_noise(base.score):
        return AT_FLOOR
    if meets_noise_together(base, context):
        return AT_FLOOR_TOGETHER
    if not accepted and context.noise_leaves_no_room(base.score):
        return NO_ROOM
    if accepted and _at_simulation_error(base, context):
        return AT_SIMULATION
    if accepted and _recordings_differ(base, context):
        return RECORDINGS_DIFFER
    most = context.rules.most_effects
    return f"{most} effects accepted, the most allowed" if len(accepted) >= most else ""


def _at_simulation_error(base: Refit, context: Context) -> bool:
    """Whether noise and the error of the simulation are all that ``base`` leaves. Beside an effect that was
    found, another one would take a part of the latter."""
    return Accuracy.of(base, context).times(base.score.rmse) <= context.rules.near_floor


def _recordings_differ(base: Refit, context: Context) -> bool:
    """Whether parameters with values of their own for each recording leave no more than noise, and ``base``,
    with one effect, far more."""
    return context.own_values and Accuracy.of(base, context).times(base.score.rmse) > context.rules.far


def out_of_time(steps: Sequence[Step], took: float, context: Context) -> str:
    """Why no further step begins after ``steps``, where less time is left than the last one ``took`` [s];
    empty if one does. The first step always begins. A step under way ends with the effect that it tries."""
    return OUT_OF_TIME if steps and not context.has_time_for(took) else ""


def two_mixed_classes(base: Refit, accepted: Sequence[Accepted], context: Context) -> str:
    """Why no effect is sought after two whose classes are mixed in the last model ``base``; empty if one is.

    Where a class shares nothing physical, chance chose the member that was accepted. The next effect may tell
    it from the others. If it does not, and was chosen by chance itself, each further effect would be judged
    beside a model that is one of many.
    """
    chosen = [(one, strangers(one.trial, one.alike)) for one in accepted]
    if not chosen or not chosen[-1][1]:
        return ""
    split, rules = context.split, context.rules
    for one, others in chosen[:-1]:
        given = [(base, one.trial, other, split, rules) for other in others]
        if any(context.mapper(still_alike, given)):
            return f"neither {one.name} nor {chosen[-1][0].name} can be told from effects unrelated to it"
    return ""
