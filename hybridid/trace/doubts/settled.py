"""What is left of a search after every doubt.

Its classes are looked at again, what only stands in for another effect is withdrawn, and the places are
sought where a learned effort still finds something.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

from hybridid.naming import listed
from hybridid.simulation.stability import MOST
from hybridid.trace.context import Context
from hybridid.trace.doubts.stand_in import (
    unless_another_form,
    unless_minor,
    unless_moved,
    unless_no_better_than_nothing,
    unless_outdone,
    unless_rivalled,
    unless_varying,
    without_mixed_classes,
    without_stand_ins,
)
from hybridid.trace.learned.ceiling import Ceiling, ceilings
from hybridid.trace.noise_floor.accuracy import Accuracy
from hybridid.trace.refits.refitted import Refit
from hybridid.trace.rules import Rules
from hybridid.trace.search.recheck import recheck
from hybridid.trace.search.search import continued
from hybridid.trace.search.steps import AT_FLOOR_TOGETHER, OUT_OF_TIME, Search
from hybridid.trace.trials.robustness import surviving

MOST_TOLD = 3
"""Places where structure remains, the strongest, that are looked at and named."""
Ceilings = tuple[Ceiling, ...]


@dataclass(frozen=True, eq=False)
class Settled:
    """What is left of a search after every doubt; the fields as ``Conclusion`` has them."""

    found: Search
    left: Ceilings
    before: Ceilings
    accuracy: Accuracy
    times: float
    remains: tuple[str, ...]

    def is_open(self, rules: Rules) -> bool:
        """Whether something is left that no effect explains."""
        return bool(self.remains) or self.times > rules.far


def settle_below_noise(found: Search, context: Context) -> Settled:
    """``found`` after every doubt, with further steps where it ended at the noise and a learned effort still
    takes a part of what is left: then the noise is less than it seems."""
    there = settle(found, context)
    if not (there.remains and there.found.at_noise):
        return there
    context.say("a learned effort still takes a part of what was held for noise: the search goes on")
    noiseless = replace(context, rules=replace(context.rules, near_floor=0.0))
    return settle(continued(there.found, noiseless), noiseless)


def settle(found: Search, context: Context) -> Settled:
    """``found`` with its classes looked at again, and without what stands in for something else.

    Where a name was withdrawn, those that are left are doubted again: they stand beside another model now.
    """
    settled = _doubted(found, context)
    while settled.found.accepted and len(settled.found.accepted) < len(found.accepted):
        found = settled.found
        settled = _doubted(found, context)
    return settled


def _doubted(found: Search, context: Context) -> Settled:
    """``found`` without what the first doubt that applies withdraws."""
    names = [one.name for one in found.accepted]
    found, left, before = _trusted(_with_sound_classes(found, context), context)
    accuracy, times = _error_left(found.final, context)
    kept = unless_minor(found, times, context.rules)
    if kept is found:
        kept = unless_no_better_than_nothing(found, context)
    if kept is found:
        kept = unless_moved(found, context)
    if kept is found:
        kept = unless_varying(found, context)
    if kept is found:
        kept = unless_another_form(found, context)
    if kept is not found:
        found, left = kept, _beside_last(kept, before, context)
        accuracy, times = _error_left(found.final, context)
    if gone := [name for name in names if name not in {one.name for one in found.accepted}]:
        context.say(f"{listed(gone)} withdrawn: {found.withdrawn or found.stopped}")
    return Settled(found, left, before, accuracy, times, _remaining(found, left, context))


def _with_sound_classes(found: Search, context: Context) -> Search:
    """``found`` with its classes looked at again, also those that a withdrawal brings back."""
    looked_at = recheck(found, context)
    kept = without_mixed_classes(looked_at, context)
    if kept is looked_at or not kept.accepted:
        return kept
    return _with_sound_classes(kept, context)


def _remaining(found: Search, left: Ceilings, context: Context) -> tuple[str, ...]:
    """The strongest places where a learned effort still finds something that survives other numerics."""
    told = _telling(left, context.rules)[:MOST_TOLD]
    return tuple(f"at {told[k].place}" for k in surviving([c.refit for c in told], found.final, context))


def _trusted(found: Search, context: Context) -> tuple[Search, Ceilings, Ceilings]:
    """``found`` without what stands in for something else, with the ceilings of its last model, and of the
    declared one if several effects had to be held against them."""
    before = learned_beside(found.first, found, context) if len(found.accepted) > 1 else ()
    kept = unless_outdone(found, before, context.rules)
    if kept is not found:
        return kept, _beside_last(kept, before, context), before
    after = learned_beside(found.final, found, context)
    kept = without_stand_ins(found, after, context)
    if kept is found:
        kept = unless_rivalled(found, context)
    return kept, (after if kept is found else learned_beside(kept.final, kept, context)), before


def _beside_last(found: Search, before: Ceilings, context: Context) -> Ceilings:
    """The ceilings of the last model; ``before`` are those of the declared one, if they are known."""
    return before if before and found.final is found.first else learned_beside(found.final, found, context)


def learned_beside(model: Refit, found: Search, context: Context) -> Ceilings:
    """The learned efforts beside ``model``, those of a step of ``found`` if it was held against them.

    None where the last model meets the noise on all horizons together: only its parameters are uncertain, and
    a learned effort could take what they err by. None where it meets the noise in more steps a sample than a
    trial is given: what it leaves is white, and each learned effort would take minutes to find nothing in it.
    None where the time limit ended the first step: there is no name to be doubted. Beside a last model at the
    noise those that promise something, and the most promising ones after a time limit that leaves no name.
    """
    if found.cut_within_a_step and not found.accepted:
        return ()
    sharp_alone = found.at_noise and model.steps > MOST
    if model is found.final and (sharp_alone or found.stopped == AT_FLOOR_TOGETHER):
        return ()
    known = (step.learned for step in found.steps if step.base is model and step.learned)
    return next(known, ()) or ceilings(model, context, promised=_to_promise(model, found, context))


def _to_promise(model: Refit, found: Search, context: Context) -> float | None:
    """The share of the fitted cost that a learned effort beside ``model`` must promise to be fitted; None for
    any. At the noise it is half of what it would have to take: to find something, an RMSE that is lower by
    ``worth``, which is a square that is lower by twice that; or to accuse an accepted effect, its share of
    what both take (``Rules.stands_in``)."""
    if context.out_of_time and (not found.accepted or _open_by_the_limit(found, context)):
        return math.inf
    if not found.at_noise or model is not found.final:
        return None
    rules, left = context.rules, model.score.loss**2
    least = min((one.trial.taken for one in found.accepted), default=math.inf)
    accuses = least * rules.stands_in / (1.0 - rules.stands_in)
    return min(2.0 * rules.worth, accuses / left if left > 0 else math.inf) / 2.0


def _open_by_the_limit(found: Search, context: Context) -> bool:
    """Whether the time limit cut the search far from the noise: the verdict is open, whatever a doubt says of
    what was accepted."""
    return found.stopped == OUT_OF_TIME and _error_left(found.final, context)[1] > context.rules.far


def _error_left(final: Refit, context: Context) -> tuple[Accuracy, float]:
    """What a complete model would leave in the place of ``final``, and the error of ``final`` over that."""
    accuracy = Accuracy.of(final, context)
    return accuracy, accuracy.times(final.score.rmse)


def _telling(found: Sequence[Ceiling], rules: Rules) -> list[Ceiling]:
    """The learned efforts that still find something, the best first.

    Those that find less than half of what the best does are left out: over the wrong variable a little of
    everything can be found.
    """
    passing = [c for c in found if c.passes(rules)]
    most = max((c.gain for c in passing), default=0.0)
    return sorted((c for c in passing if c.gain >= most / 2), key=lambda c: -c.gain)
