"""Declared parameters that a proposed law shares a constant with.

A law k f(q) v beside a viscous friction f_v v adds up with it: (f_v + k f(q)) v. How much of that is f_v
depends on the formula f. Its interval holds beside this formula alone.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from hybridid.effects.composed import ComposedLaw
from hybridid.effects.over import MEMORIES
from hybridid.trace.context import Context
from hybridid.trace.learned.law_curve import binned
from hybridid.trace.ports.path import Path
from hybridid.trace.verdict import Conclusion

CONSTANTS: Mapping[str, str] = {"velocity": "viscous", "sign of velocity": "coulomb", "": "offset"}
"""Factor of a law -> the effect that is a constant times it."""
USUAL = 0.1
"""Of the root mean square of what multiplies the factor, its median from which on a constant is shared: a law
that is nothing most of the time leaves the constant alone."""


def shares_a_constant(found: Conclusion, context: Context) -> str:
    """Which declared effects are a constant beside a proposed law over another variable, in words; else
    empty."""
    final, told = found.search.final, ""
    for one in found.accepted:
        law, port = one.trial.candidate.effect.law, one.trial.candidate.port
        if not isinstance(law, ComposedLaw) or law.level is not None:
            continue
        if law.over.variable == "velocity" or law.over.variable in MEMORIES:
            continue
        path = Path.of(final, context.split, context.split.fitted)
        seen, factor = path.seen(port, law.over), path.factor(port, law.over)
        along = binned(seen, path.effort_of(one.name, port), factor).over(seen)
        if abs(np.median(along)) <= USUAL * np.sqrt(np.mean(along**2)):
            continue
        constant = CONSTANTS.get(law.over.factor)
        terms = [t.name for t in final.model.terms if t.port == port and t.effect.id == constant]
        for name in terms:
            told += (
                f" {name} and {one.name} add up: the parameter of {name} is known beside this formula alone. "
                "Another one that fits as well may leave it another value."
            )
    return told
