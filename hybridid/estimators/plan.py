"""What a descent is asked to do, where it begins and where it ended."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from hybridid.estimators.estimate import Solution
from hybridid.estimators.method import GAUSS_NEWTON, STOP, Method
from hybridid.estimators.problem import Problem
from hybridid.estimators.stop import Stop, Watch

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Handover:
    """Inner states are handed on at most ``times``, each time with a descent of its own."""

    times: int
    stop: Stop


@dataclass(frozen=True)
class Refinement:
    """Shorter steps are taken at most ``times``, each time with its own ``handover``; ``must_hold`` keeps the
    longer steps where the simulation with the shorter ones diverges."""

    times: int
    handover: Handover
    must_hold: bool


@dataclass(frozen=True)
class Descent:
    """Settings of a descent.

    ``continuation`` multiplies the smoothing widths, one after the other; ``stop`` ends each. ``screening``
    ends the short descent from each start, at the widest and the narrowest smoothing alone. The start with
    the lowest cost then descends to convergence, by every smoothing unless the records refute the widest. It
    does not if its cost is above ``hopeful`` and a Gauss-Newton step promises none below. None: every start
    does, and the lowest cost is kept. Above ``cost_limit`` inner states are not handed on.
    """

    handover: Handover
    refinement: Refinement
    method: Method = GAUSS_NEWTON
    continuation: tuple[float, ...] = (1.0,)
    stop: Stop = STOP
    screening: Stop | None = None
    cost_limit: float = np.inf
    hopeful: float = np.inf


@dataclass(frozen=True)
class Start:
    """A problem, and where to begin in it: parameters (n_p,), initial states of all horizons (w, n_x).

    ``candidates`` are the initial states (w, n_x) that the second look chooses from, none for no second look.
    """

    problem: Problem
    p: Array
    x0: Array
    candidates: tuple[Array, ...] = ()
    watch: Watch | None = None


@dataclass(frozen=True)
class Look:
    """Where a short descent ended (``seen``), and the ``start`` from which it goes on by the smoothings
    ``factors``."""

    start: Start
    seen: Solution
    factors: tuple[float, ...]

    def rest_of(self, plan: Descent) -> Descent:
        """``plan`` with the iterations of the smoothings that are left out."""
        times = len(plan.continuation) // len(self.factors)
        return replace(plan, stop=replace(plan.stop, iterations=times * plan.stop.iterations))


@dataclass(frozen=True)
class Result:
    """Where a descent ended: the ``solution`` on the fitted horizons, initial states ``x0`` (w, n_x) of all
    horizons, and the cost at which each of the ``starts`` ended that were carried to the end. ``diverged``
    are the numbers of those whose short descent could not be simulated. ``ended_early``: none was hopeful;
    ``looks`` are then the ends of the short descents, the lowest cost first."""

    problem: Problem
    solution: Solution
    x0: Array
    starts: tuple[float, ...] = ()
    diverged: tuple[int, ...] = ()
    ended_early: bool = False
    looks: tuple[Look, ...] = ()
