"""The integrator's steps made shorter where they leave a part of the error.

Their number follows from the eigenvalues along the recorded motion, so that smooth motion is integrated well.
An edge is not smooth: where a stop, a weir or the kink of a friction lies within a step, the step errs in
proportion to its length, however stable it is. An effect that only makes up for this seems to be missing. So
before effects are tried beside a model, it is simulated in steps of half the length. If its residual changes
by more than ``COARSE``, it is refitted with these, and again, as long as that takes as much from the held-out
error as an effect must (``Rules.worth``). It is the simulation's error that goes: no law was added.

Source: Hairer, Nørsett, Wanner (1993), Solving Ordinary Differential Equations I, sec. II.6 (discontinuous
equations); Roache (1998), Verification and Validation in Computational Science and Engineering, ch. 3.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from hybridid.estimators.fit import COARSE
from hybridid.naming import counted
from hybridid.simulation.stability import MOST
from hybridid.trace.context import Context
from hybridid.trace.refits.refit import refit_if_possible
from hybridid.trace.refits.refitted import Refit
from hybridid.trace.search.halving import halved_while_it_pays


def in_short_steps(base: Refit, context: Context) -> Refit:
    """``base``, or its refit in as short steps as pay.

    Where a half does not pay, a quarter may: how far a step errs depends on where the edge lies in it.
    """

    def half_of(one: Refit) -> Refit | None:
        return _in_half_the_step(one, context) if _step_shows(one, context) else None

    return halved_while_it_pays(base, half_of, _said, context)


def _said(found: Refit) -> str:
    return f"the integrator takes {counted(found.substeps, 'step')} a sample"


def _in_half_the_step(base: Refit, context: Context) -> Refit | None:
    """``base`` refitted in half the step; None where it cannot be, or takes more than ``MOST`` a sample."""
    if 2 * base.substeps > MOST:
        return None
    half = replace(base.numerics, finer=2 * base.numerics.finer)
    given = (base.model, context.split, [base.values], base, half, math.inf)
    (again,) = context.each("shorter steps", refit_if_possible, [given])
    return again


def _step_shows(base: Refit, context: Context) -> bool:
    """Whether half the step changes the held-out residual of ``base`` by a share that could matter."""
    problem, held_out = base.problem(context.split), list(context.split.held_out)
    left, moved = problem.moved_by_half_the_step(base.x0, base.model.values(base.values))
    return bool(np.linalg.norm(moved[held_out]) > COARSE * np.linalg.norm(left[held_out]))
