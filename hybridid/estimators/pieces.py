"""A problem over short pieces of its records, where its cost is nearly quadratic and quick to compute.

A piece begins in an initial state of its own, so a model with poor parameters stays near what was recorded.
Source: Ribeiro, Tiels, Umenberger, Schön, Aguirre (2020), "On the smoothness of nonlinear system
identification", Automatica 121, 109158.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from hybridid.estimators.estimate import Solution
from hybridid.estimators.method import GAUSS_NEWTON
from hybridid.estimators.problem import Problem
from hybridid.estimators.start import best_initial_states, x0_candidates
from hybridid.estimators.stop import Stop
from hybridid.simulation.windows import cut

Array = NDArray[np.float64]
PARTS = 20
"""Pieces that the longest record would give."""
SHORTEST, LONGEST = 50, 1000
"""Samples of a piece."""
MOST, FEWEST = 5000, 4
"""Samples of all pieces together, as a rule; pieces at least."""
LOOSE = Stop(30, 1e-4)


def pieces(problem: Problem, parts: int = PARTS, most: int = MOST, fits: int = 1, share: int = 1) -> Problem:
    """``problem`` over pieces of a ``parts``-th of its longest record, and of a ``share``-th of its longest
    horizon at most, evenly chosen, of ``most`` samples together; it shares the compiled code. ``fits`` is how
    many fits are to come.

    Horizons that are short already keep their length.
    """
    longest, horizon = max(record.n for record in problem.records), max(problem.windows.lengths)
    length = int(np.clip(longest // parts, SHORTEST, LONGEST))
    length = min(horizon, length, max(SHORTEST, horizon // share))
    windows = cut(problem.records, length, problem.windows.substeps, max(most // length, FEWEST))
    shooter = problem.shooter.over(windows, fits)
    return replace(problem, windows=windows, shooter=shooter, estimate_x0=True)


def best_of(problem: Problem, starts: Sequence[Array], stop: Stop = LOOSE) -> Solution:
    """The lowest cost that a descent from one of ``starts`` (n_p,) reaches; infinite if each diverges."""
    found = []
    for p in starts:
        x0 = best_initial_states(problem, p, x0_candidates(problem, p))
        found.append(GAUSS_NEWTON.solve(problem, p, x0, (1.0,), stop))
    return found[int(np.argmin([one.cost for one in found]))]
