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

from hybridid.trace.alike import tells_apart
from hybridid.trace.context import Context
from hybridid.trace.evidence import compare
from hybridid.trace.refit import WITHOUT_STD, Refit, refit_if_possible
from hybridid.trace.rules import Rules
from hybridid.trace.split import Split
from hybridid.trace.trial import PASSED, Trial

NARROWER = 0.25
"""Of the width over which sign(v) is smoothed: the error that the smoothing leaves falls at least as much."""


def smoothed_apart(best: Refit, other: Refit, split: Split, rules: Rules) -> bool:
    """Whether a narrower smoothing no longer tells ``other`` from ``best``, which leaves less as declared."""
    if not best.model.smooths:
        return False
    numerics = replace(best.numerics, name="epsilon / 4", smoothing=NARROWER)
    refits = [
        refit_if_possible(one.model, split, [one.values], one, numerics, WITHOUT_STD) for one in (best, other)
    ]
    first, second = refits
    if first is None or second is None:
        return False
    return not tells_apart(compare(second.score, first.score), rules)


def rivals_smoothed_apart(
    best: Trial, members: Sequence[Trial], judged: Sequence[Trial], context: Context
) -> list[Trial]:
    """The ``judged`` trials that passed, take most of what ``best`` takes, are no ``members`` of its class,
    and are not told from it with a narrower smoothing."""
    rivals = [
        t
        for t in judged
        if t.status == PASSED and t not in members and t.taken >= context.rules.majority * best.taken
    ]
    given = [(best.refit, rival.refit, context.split, context.rules) for rival in rivals]
    alike = context.each("by a narrower smoothing", smoothed_apart, given)
    return [rival for rival, is_so in zip(rivals, alike, strict=True) if is_so]
