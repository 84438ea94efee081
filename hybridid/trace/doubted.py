"""Declared effects that may be the wrong law: functions of the variable over which structure remains.

Where nothing that was tried explains the errors, and a learned effort over a variable does, a declared effect
that is itself a function of that variable may be wrong: a search that only adds cannot replace it. So may any
declared effect where no learned effort helps either.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from hybridid.model import Model
from hybridid.naming import listed
from hybridid.trace.ceiling import Ceiling
from hybridid.trace.context import Context
from hybridid.trace.law_curve import is_curve_over
from hybridid.trace.path import Path
from hybridid.trace.refit import Refit
from hybridid.trace.split import Split
from hybridid.trace.verdict import Conclusion

CONSTANT = 0.1
"""Share of its mean square below which the variance of an effort is that of a constant: no function of a
variable."""


def doubted(declared: Model, final: Refit, places: Sequence[Ceiling], split: Split) -> list[str]:
    """Names of the ``declared`` effects, still in the model of ``final``, that are functions of the variable
    of a learned effort of ``places`` at their port."""
    path = Path.of(final, split, split.fitted)

    def varies(name: str, port: str) -> bool:
        effort = path.effort_of(name, port)
        return bool(np.var(effort) > CONSTANT * np.mean(effort**2))

    return [
        term.name
        for term in declared.terms
        if term in final.model.terms
        and any(
            one.port == term.port
            and varies(term.name, one.port)
            and is_curve_over(final, term.name, one.port, one.over, split)
            for one in places
        )
    ]


def revision_advised(found: Conclusion, context: Context) -> str:
    """That ``trace.revise`` may help, in words, where a declared effect may be the wrong law; else empty."""
    if found.verdict != "unexplained" or context.revise:
        return ""
    declared = [term.name for term in found.search.final.model.terms]
    if declared and not (found.remains or found.accepted):
        was = "were" if len(declared) > 1 else "was"
        return (
            f" The declared {listed(declared)} {was} not questioned: trace.revise=true seeks others in the "
            "place of each."
        )
    places = [one for one in found.ceilings if f"at {one.place}" in found.remains]
    names = doubted(found.search.first.model, found.search.final, places, context.split)
    if not names:
        return ""
    return (
        f" What is declared over that variable ({listed(names)}) may be the wrong law: trace.revise=true "
        "seeks others in its place."
    )
