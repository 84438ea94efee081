"""Rivals that only the smoothing of sign(v) tells from the best effect.

Where friction is smoothed more widely than the machine slips, each model is left with an error of the
simulation. An effect with one more shape parameter can take a part of that error, and then leaves less than
the true one. With a narrower smoothing that error is gone. So the best effect and those that take most of
what it takes are compared once more with sign(v) smoothed over a quarter of the width. Those that are not
told apart there are one class: the advantage was the simulation's.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from hybridid.trace.context import Context
from hybridid.trace.horizons.evidence import compare
from hybridid.trace.horizons.split import Split
from hybridid.trace.refits.refit import WITHOUT_STD, refit_if_possible
from hybridid.trace.refits.refitted import Refit
from hybridid.trace.rules import Rules
from hybridid.trace.trials.alike import tells_apart
from hybridid.trace.trials.trial import PASSED, Trial

NARROWER = 0.25
"""Of the width over which sign(v) is smoothed: the error that the smoothing leaves falls at least as much."""


def smoothed_apart(best: Refit, other: Refit, split: Split, rules: Rules) -> bool:
    """Whether a narrower smoothing no longer tells ``other`` from ``best``, which leaves less as declared."""
    return best.model.smooths and _alike_there(best, _narrower(best, split), _narrower(other, split), rules)


def rivals_smoothed_apart(
    best: Trial, members: Sequence[Trial], judged: Sequence[Trial], context: Context
) -> list[Trial]:
    """The ``judged`` trials that passed, take most of what ``best`` takes, are no ``members`` of its class,
    and are not told from it with a narrower smoothing."""
    assert best.refit is not None
    passed = [t for t in judged if t.status == PASSED and t not in members]
    rivals = [t for t in passed if t.taken >= context.rules.majority * best.taken]
    if not (rivals and best.refit.model.smooths):
        return []
    given = [(t.refit, context.split) for t in (best, *rivals)]
    there, *others = context.each("by a narrower smoothing", _narrower, given)
    return [
        t
        for t, other in zip(rivals, others, strict=True)
        if _alike_there(best.refit, there, other, context.rules)
    ]


def _narrower(one: Refit, split: Split) -> Refit | None:
    """``one`` with the narrower smoothing; None if it cannot be simulated so."""
    numerics = replace(one.numerics, name="epsilon / 4", smoothing=NARROWER)
    return refit_if_possible(one.model, split, [one.values], one, numerics, WITHOUT_STD)


def _alike_there(best: Refit, there: Refit | None, other: Refit | None, rules: Rules) -> bool:
    """Whether ``other`` is not told from ``there``, which is ``best`` with the narrower smoothing.

    That says something only if the refit of ``there`` has converged, and if the narrower smoothing explains
    the records as well: a friction that is as smooth as declared would leave more with it.
    """
    if there is None or other is None or not there.converged:
        return False
    as_good = there.score.loss <= (1 + rules.tie) * best.score.loss
    return as_good and not tells_apart(compare(other.score, there.score), rules)
