"""In words, which gains were refused where no name is given: the best supported one, and the largest. And why
what passed was not accepted."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import takewhile
from operator import attrgetter

from hybridid.naming import listed
from hybridid.quantities import share
from hybridid.trace.entries import StepTaken, TriedEffect, TriedPair
from hybridid.trace.results.result import Trace
from hybridid.trace.search.steps import Accepted
from hybridid.trace.trials.judgement import NOT_SIGNIFICANT
from hybridid.trace.trials.trial import PASSED, Trial

EVIDENT = 2.0
"""Times the smallest p-value up to which the evidence is about the same: few horizons give few p-values."""

Refused = TriedEffect | TriedPair


def most_refused(found: Trace) -> str:
    """The gain of an effect or a pair that was refused beside the last model and has the most evidence, and
    why; empty if none of them is worth having, or possible. Of those with about the same evidence that is the
    largest. One that takes more still by what is worth having is told as well: what few horizons cannot show
    may be there. A p-value of 1 is no evidence: then the largest is told as what it is."""
    possible = _possible(found)
    if not possible:
        return ""
    evident = EVIDENT * max(found.rules.alpha, min(one.p_value for one in possible))
    best = max((one for one in possible if one.p_value <= evident), key=attrgetter("gain"))
    largest = max(possible, key=attrgetter("gain"))
    if best.p_value >= 1.0 and best.reason not in found.withdrawn:
        return f" Chance alone explains each of the refused gains. The largest is {_told(largest, found)}."
    told = f" The best supported of the refused gains is {_told(best, found)}."
    if largest.gain < best.gain + found.rules.worth:
        return told
    return f"{told} The largest is {_told(largest, found)}."


def largest_refused(found: Trace) -> str:
    """The largest significant gain that was refused beside the last model, and why; empty without one."""
    likely = [one for one in _possible(found) if one.p_value <= found.rules.alpha]
    if not likely:
        return ""
    return f"the largest of the refused gains is {_told(max(likely, key=attrgetter('gain')), found)}"


def refused_for_significance(found: Trace) -> bool:
    """Whether a gain worth having was refused beside the last model for its p-value alone."""
    return any(one.reason.startswith(NOT_SIGNIFICANT) for one in _possible(found))


def _possible(found: Trace) -> list[Refused]:
    """What was refused beside the last model, is worth having, and takes no more than a complete model. Of a
    pair each must be worth having beside the other: else the other one alone is told."""
    worth = found.rules.worth
    # where the error is far above the noise, no gain can come from fitting the noise
    times = math.inf if found.times > found.rules.far else found.times
    refused: list[Refused] = []
    for step in _beside_the_last_model(found):
        refused += [*step.trials, *step.pairs]
    return [
        one
        for one in refused
        if one.status != PASSED
        and not (isinstance(one, TriedEffect) and (one.is_law or _undetermined(one)))
        and min((one.gain, *(one.gains if isinstance(one, TriedPair) else ()))) >= worth
        and not more_than_possible(one.gain, times)
    ]


def _undetermined(one: TriedEffect) -> bool:
    """Whether significance refused it, and none of its parameters is known to a half of its value."""
    known = [value for value in one.parameters.values() if math.isfinite(value.std)]
    vague = bool(known) and all(2 * value.std > abs(value.value) for value in known)
    return vague and one.reason.startswith(NOT_SIGNIFICANT)


def _beside_the_last_model(found: Trace) -> list[StepTaken]:
    """The last steps, in which nothing was taken."""
    return list(takewhile(lambda step: not step.taken, reversed(found.steps)))


def _told(one: Refused, found: Trace) -> str:
    """``57.8 % with body.side_capacity and power.input_nonlinearity: not significant``."""
    name = " and ".join(one.effects) if isinstance(one, TriedPair) else one.name
    gain = f"{share(one.gain)} with {name}"
    return gain if one.reason in found.withdrawn else f"{gain}: {one.reason}"


def more_than_possible(gain: float, times: float) -> str:
    """That a gain takes more than what a complete model could, where the error left is ``times`` that of
    noise and simulation; else empty."""
    if gain <= 1.0 - 1.0 / times:
        return ""
    return " No effect that is there could take as much: this one fits noise, or an error of the simulation."


def why_passed_over(trial: Trial, taken: Sequence[Accepted]) -> str:
    """Why a ``trial`` that passed was not accepted: what its step has ``taken`` instead, if that is not gone
    since."""
    if not taken:
        return "but less than what was accepted in its step, which was withdrawn later"
    names = listed([one.name for one in taken])
    if trial.gain < taken[0].trial.gain:
        return f"but less than {names}, accepted in its step"
    return f"but it is not shown to explain more than {names}, accepted in its step"
