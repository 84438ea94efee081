"""A second descent that begins elsewhere, where the first leaves more than noise and simulation do.

Over a long horizon the cost may have many valleys, and a descent ends in the one where it begins. Whether the
first one is the lowest, no gradient tells. Over short pieces of the record the cost has hardly any: the
parameters found there are a start of their own. A descent from there that promises no lower cost ends early.
A fit whose horizons are no longer than such pieces has none to look for.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from hybridid.estimators.descent import descend
from hybridid.estimators.method import LEARNING
from hybridid.estimators.pieces import best_of, pieces
from hybridid.estimators.plan import Descent, Result, Start
from hybridid.estimators.start import best_initial_states, x0_candidates
from hybridid.estimators.stop import Stop, Watch

Array = NDArray[np.float64]
SHARE = 10
"""By which the horizon is divided, at least."""
CLEARLY = 0.99
"""Share of the first descent's cost above which the second has found nothing new: a rough cost ends a descent
anywhere in the last percent."""
LOOK = Stop(5, 1e-3)
"""The short descent that shows whether it is worth while to go on."""


def elsewhere(found: Result, plan: Descent, starts: Sequence[Array], watch: Watch | None) -> Result | None:
    """Where a descent ends that begins at the best fit over short pieces, itself begun at each of ``starts``
    (n_p,); None if that promises no cost clearly below that of ``found``, or if its horizons are as short."""
    problem = found.problem
    parts = pieces(problem, share=SHARE)
    if max(parts.windows.lengths) >= max(problem.windows.lengths):
        return None
    short = best_of(parts, starts)
    if not np.isfinite(short.cost):
        return None
    p = short.p
    candidates = x0_candidates(problem, p) if problem.estimate_x0 else [problem.measured_x0()]
    start = Start(problem, p, best_initial_states(problem, p, candidates), tuple(candidates), watch)
    second = replace(
        plan,
        method=LEARNING,
        continuation=plan.continuation[-1:],
        screening=replace(LOOK, iterations=min(LOOK.iterations, plan.stop.iterations)),
        hopeful=CLEARLY * found.solution.cost,
    )
    result = descend([start], second)
    return result if np.isfinite(result.solution.cost) and not result.ended_early else None
