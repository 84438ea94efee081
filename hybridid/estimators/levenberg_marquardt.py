"""Levenberg-Marquardt on the reduced least squares, parameters and initial states together.

Each step d solves ``(J' J + lambda diag(J' J)) d = J' r``, with lambda adapted by the ratio of the actual
to the predicted decrease of the cost. Source: Björck (1996), Numerical Methods for Least Squares Problems,
sec. 9.2; damping by Nielsen (1999), IMM-REP-1999-05.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from hybridid.estimators.carried import carry
from hybridid.estimators.coupled import Coupled
from hybridid.estimators.estimate import Solution
from hybridid.estimators.normal_equations import Normal
from hybridid.estimators.problem import Problem
from hybridid.estimators.reduced import LeastSquares, Reduced
from hybridid.estimators.rough_horizons import POOR, has_own_states, mended
from hybridid.estimators.secant import Secant
from hybridid.estimators.separate import is_separate, solve_separately
from hybridid.estimators.stop import SLOW_GAIN, SLOW_SHARE, SLOW_STEPS, Stop, Watch
from hybridid.estimators.wide_steps import in_wide_steps

Array = NDArray[np.float64]
MOST_DAMPING = 1e12
LOOSE = 1e-4
"""Tolerance of the descents at coarser smoothing, which only lead to the next."""
STUBBORN = 2.0**3
"""Growth of the damping after two trials of a step have failed: the next is mended where it fails."""
REST = 0.1
"""Standard errors, of white noise, by which parameters that stand still may move in ``SLOW_STEPS`` steps."""
ROUNDS = 10
"""Descents from better initial states, at most."""
CONVERGED, ROUGH = "converged", "converged (slowly: rough cost)"


@dataclass(frozen=True)
class LevenbergMarquardt:
    """Damped Gauss-Newton steps.

    Converged means that the predicted relative decrease of a full Gauss-Newton step is below the tolerance,
    that only rounding is left, or that the cost is rough: the last ``SLOW_STEPS`` steps together gained
    hardly more than the tolerance or, where horizons have initial states of their own, hardly moved the
    parameters; or no step lowers the cost and none predicted more.

    ``mends``: a step that fails in a few horizons is mended there (``rough_horizons``). ``learns``: where
    initial states are known, steps learn from those before (``secant``). A fit does both. Refits that are
    compared with each other by small differences, as in a trace, do not: where the cost has many valleys, it
    decides in which a descent ends.
    """

    mends: bool = False
    learns: bool = False
    solves: ClassVar[tuple[type, ...]] = (Reduced,)
    hands_on: ClassVar[bool] = True
    """Whether inner states run on from horizon to horizon during the descent."""

    def solve(
        self,
        transcription: Reduced,
        problem: Problem,
        p: Array,
        x0: Array,
        factors: Sequence[float],
        stop: Stop,
        watch: Watch | None,
    ) -> Solution:
        """Minimise the cost from ``p`` (n_p,), ``x0`` (w, n_x); one descent for each of ``factors``."""
        variables = transcription.least_squares(problem)
        if is_separate(problem):
            return solve_separately(variables, problem.smoothed(p, factors[-1]), x0, stop)
        begun = 0
        for factor in factors[:-1] if problem.widths else ():
            coarse, smoothed = replace(stop, tolerance=LOOSE), problem.smoothed(p, factor)
            wide = transcription.least_squares(in_wide_steps(problem, p, factor))
            found = _descend(wide, smoothed, x0, coarse, _from(watch, begun), self.mends, self.learns)
            p, x0, begun = found.p, found.x0, begun + found.iterations
        smoothed = problem.smoothed(p, factors[-1])
        found = _descend(variables, smoothed, x0, stop, _from(watch, begun), self.mends, self.learns)
        if self.mends:
            found = _with_better_states(variables, found, stop, _from(watch, begun))
        return replace(found, x0=carry(problem, found.p, found.x0), iterations=begun + found.iterations)


def _from(watch: Watch | None, begun: int) -> Watch:
    """``watch`` counting on from ``begun`` iterations."""
    return lambda iteration, cost: watch(begun + iteration, cost) if watch else None


def _descend(
    variables: LeastSquares,
    p: Array,
    x0: Array,
    stop: Stop,
    watch: Watch,
    mends: bool = False,
    learns: bool = False,
) -> Solution:
    """One Levenberg-Marquardt descent at one smoothing."""
    problem, tolerance = variables.problem, stop.tolerance
    p, x0 = variables.inside(p, x0)
    shot = problem.shot(x0, p, sensitivities=True)
    cost = problem.cost(shot)
    if not np.isfinite(cost):
        return Solution(p, x0, np.inf, "the simulation diverges at the start", False, 0)
    damping, growth, history = 1e-4, 2.0, [cost]
    slow = min(SLOW_SHARE * tolerance, SLOW_GAIN)
    apart = mends and has_own_states(problem)
    places = [p]
    learned = Secant.of(variables) if learns else None
    for iteration in range(1, stop.iterations + 1):
        normal = variables.linearised(shot if shot.sensitive else problem.shot(x0, p, True))
        if not normal.finite:
            blown = "the sensitivities diverge: the integrator needs shorter steps"
            return Solution(p, x0, cost, blown, False, iteration, tuple(history))
        learned = learned and learned.at(p[variables.positions] / variables.p, cost, normal)
        held = variables.held(p, normal.gp)
        normal = normal.holding(variables.held_states(x0, normal.gx))
        here = shot
        equations = learned.added_to(normal) if learned else normal
        step = equations.step(damping, held)
        if cost <= problem.rounding or _promises_little(normal, held, cost, tolerance, step):
            return Solution(p, x0, cost, CONVERGED, True, iteration - 1, tuple(history))
        slopes = iteration < stop.iterations  # most first trials are taken, and then slopes are needed
        while True:
            trial_p, trial_x = variables.moved(p, x0, *step)
            promised = equations.predicted(*variables.between(p, x0, trial_p, trial_x))
            shot = problem.shot(trial_x, trial_p, slopes, limit=np.inf if apart else cost)
            if apart and growth >= STUBBORN:
                trial_x, shot = mended(problem, (x0, here), (trial_x, shot), trial_p, cost - POOR * promised)
            trial = problem.cost(shot)
            ratio = (cost - trial) / promised if promised > 0 else -1.0
            if np.isfinite(trial) and ratio > 0:
                break
            damping, growth, slopes, equations = damping * growth, growth * 2, False, normal
            if damping > MOST_DAMPING:
                there = _promises_little(normal, held, cost, slow)
                status = ROUGH if there else "stalled: no step lowers the cost"
                return Solution(p, x0, cost, status, there, iteration, tuple(history))
            step = equations.step(damping, held)
        damping *= max(1 / 10, 1 - (2 * ratio - 1) ** 3)
        damping, growth = max(damping, 1e-12), 2.0
        p, x0, cost = trial_p, trial_x, trial
        history.append(cost)
        places.append(p)
        watch(iteration, cost)
        if _creeps(history, slow) or (apart and _at_rest(variables, normal, places, history)):
            return Solution(p, x0, cost, ROUGH, True, iteration, tuple(history))
    most = stop.iterations
    return Solution(p, x0, cost, f"stopped after {most} iterations", False, most, tuple(history))


def _with_better_states(variables: LeastSquares, found: Solution, stop: Stop, watch: Watch) -> Solution:
    """``found``, where its cost is rough: the initial states are sought horizon by horizon, and as long as
    they lower the cost, the descent goes on from there."""
    problem = variables.problem
    if found.status != ROUGH or not has_own_states(problem):
        return found
    apart = LeastSquares.of(problem.estimating(()))
    for _ in range(ROUNDS):
        states = solve_separately(apart, found.p, found.x0, stop)
        if found.cost - states.cost <= SLOW_GAIN * found.cost:
            break
        begun = found.iterations
        further = _descend(variables, found.p, states.x0, stop, _from(watch, begun), mends=True)
        found = replace(
            further, iterations=begun + further.iterations, history=(*found.history, *further.history)
        )
    return found


def _creeps(history: Sequence[float], gain: float) -> bool:
    """Whether the last ``SLOW_STEPS`` steps together lowered the cost by less than the share ``gain``."""
    return len(history) > SLOW_STEPS and history[-SLOW_STEPS - 1] - history[-1] < gain * history[-1]


def _at_rest(
    variables: LeastSquares, normal: Normal | Coupled, places: Sequence[Array], history: Sequence[float]
) -> bool:
    """Whether the last ``SLOW_STEPS`` steps moved the parameters by less than ``REST`` standard errors, and
    gained little. ``normal`` are the equations before the last step."""
    if not (_creeps(history, SLOW_GAIN) and isinstance(normal, Normal)):
        return False
    problem = variables.problem
    moved = (places[-1] - places[-1 - SLOW_STEPS])[variables.positions] / variables.p
    variance = 2.0 * history[-1] / (problem.windows.samples * len(problem.scale))
    return normal.of_parameters(moved) < REST**2 * variance


def _promises_little(
    normal: Normal | Coupled,
    held: NDArray[np.bool_],
    cost: float,
    tolerance: float,
    step: tuple[Array, Array] | None = None,
) -> bool:
    """Whether even the undamped step would hardly lower the cost. No step promises more than that one, so a
    ``step`` that promises enough spares it."""
    little = tolerance * max(cost, np.finfo(float).tiny)
    if step is not None and normal.predicted(*step) > little:
        return False
    return normal.predicted(*normal.step(1e-10, held)) <= little
