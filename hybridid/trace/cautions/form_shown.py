"""How far another law may differ from a named one and still explain the records as well.

An effect takes T from the square of the held-out error, and the last model leaves L². A true law that differs
by the share e of what the effect does to the outputs would leave e² T less. The rules tell two effects apart
only where one leaves less by ``Rules.tie`` of the RMSE at least. So nothing tells of a difference up to

    e = sqrt((1 - (1 - tie)²) L² / T)

With a tie of 2 % that is 60 % for an effect alone that takes 5 % of the RMSE, 20 % for one that takes 30 %,
and 4 % for one that takes 80 %: what the records hardly show is there, but its form is the library's guess.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

from hybridid.naming import listed
from hybridid.quantities import percent
from hybridid.trace.rules import Rules
from hybridid.trace.search.steps import Accepted

TOLD = 0.2
"""The difference, as a share of what an effect does to the outputs, from which it is told."""


def hidden_difference(taken: float, left: float, tie: float) -> float:
    """Share of what an effect does to the outputs by which another law may differ unseen, at most 1: it takes
    so much ``taken`` from the squared error, and ``left`` is what the last model leaves of it."""
    return min(1.0, math.sqrt((1 - (1 - tie) ** 2) * left / taken)) if taken > 0 else 1.0


def form_hardly_shown(accepted: Sequence[Accepted], loss: float, rules: Rules) -> str:
    """Of which accepted effects the records show little of the form, in words; empty if of none. ``loss`` is
    that of the last model. Of a class that is told already, and what two effects take only together says
    nothing of either."""
    alone = [one for one in accepted if len(one.alike) == 1 and not one.together]
    told = [(one.name, hidden_difference(one.trial.taken, loss**2, rules.tie)) for one in alone]
    vague = [(name, hidden) for name, hidden in told if hidden >= TOLD]
    if not vague:
        return ""
    names = listed([f"{name} ({percent(hidden, 0)})" for name, hidden in vague])
    several, their = ("are", "their forms") if len(vague) > 1 else ("is", "its form")
    return (
        f" These records show that {names} {several} there, but little of {their}: they cannot tell it from "
        "a law that differs in what it does to the outputs by that share."
    )
