"""A width or a step of the simulation is halved as long as that pays."""

from __future__ import annotations

from collections.abc import Callable

from hybridid.trace.context import Context
from hybridid.trace.horizons.evidence import compare
from hybridid.trace.refits.refitted import Refit

MOST_HALVINGS = 4
"""Times that a width or a step is halved before one search for an effect: each costs a simulation twice."""


def halved_while_it_pays(
    base: Refit, half_of: Callable[[Refit], Refit | None], said: Callable[[Refit], str], context: Context
) -> Refit:
    """``base``, or the last of its refits by ``half_of`` that takes ``Rules.worth`` from the held-out error
    of the one kept before; the trace is told what is ``said`` of each. None: it cannot be halved any more.

    Where a half does not pay, a quarter may, which is looked at, too.
    """
    kept = last = base
    for _ in range(MOST_HALVINGS):
        again = half_of(last)
        if again is None:
            break
        if compare(kept.score, again.score).gain >= context.rules.worth:
            kept = last = again
            context.say(f"{said(kept)} from here on: that leaves less error")
        elif last is not kept:
            break
        else:
            last = again
    return kept
