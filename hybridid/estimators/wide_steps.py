"""Steps a sample for a descent that smooths sign(v) more widely than declared.

Near rest the slope of a smoothed dry friction is f_c / (m epsilon), and an explicit integrator's step is
about the inverse of that. Where the smoothing is wider, longer steps are as stable and as accurate. A descent
there only leads to the next one, at the declared smoothing and in the steps that this needs.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from hybridid.estimators.problem import Problem
from hybridid.simulation.chosen import EXPLICIT
from hybridid.simulation.stability import substeps_wanted

Array = NDArray[np.float64]
MANY = 8
"""Steps a sample up to which to count fewer takes longer than it saves."""


def in_wide_steps(problem: Problem, p: Array, factor: float) -> Problem:
    """``problem`` in as many steps a sample as it needs at ``p`` (n_p,) with smoothing widths ``factor``
    times as wide: fewer by the ratio of what either needs there. It stays as it is where it takes few."""
    windows, shooter = problem.windows, problem.shooter
    if factor <= 1 or windows.substeps <= MANY or shooter.integrator != EXPLICIT or not problem.widths:
        return problem
    declared, wide = (_wanted(problem, problem.smoothed(p, one)) for one in (1.0, factor))
    steps = max(1, math.ceil(windows.substeps * wide / declared))
    return problem.in_steps(steps) if steps < windows.substeps else problem


def _wanted(problem: Problem, p: Array) -> int:
    return substeps_wanted(problem.model, p, problem.records, integrator=problem.shooter.integrator)
