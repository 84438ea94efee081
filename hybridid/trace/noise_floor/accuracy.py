"""How near the error that is left comes to the smallest error that a complete model could leave.

Three things separate a complete model from the measured output: the sensor's noise, what that noise has done
to the parameters, and the simulation's error.

The noise n of the fitted horizons, with the standard deviation sigma of each output, moves the parameters by
``H^-1 J' n``, J being the Jacobian of their outputs, initial states projected out, and ``H = J' J``. On the
held-out horizons, with the Jacobian K, this adds an error of the mean square

    mean of diag(K H^-1 (sum over outputs of sigma^2 J_y' J_y) H^-1 K')

Where the held-out motion is like the fitted one, it is small: as many parts of sigma^2 as there are
parameters for each sample. Where it is larger, a parameter that is known well enough there is not known well
enough here.

The simulation's error has two causes: friction at rest is smoothed to tanh(v/epsilon), so the model creeps
where the machine sticks, and the integrator's step has a finite length. The error s of the simulation is
found by Richardson's extrapolation, from the held-out errors e before, and e' after all
is refitted with epsilon / 2 or with half the step. With r from other causes, and a method of order k,

    e^2 = r^2 + s^2,    e'^2 = r^2 + s^2 / 4^k,    so that s^2 = (e^2 - e'^2) 4^k / (4^k - 1).

The order is one in epsilon and four in the step of RK4. Where the finer simulation leaves no smaller error, s
is taken as zero. Where half of epsilon is too stiff to be simulated, the error e'' with twice of it tells:

    e''^2 = r^2 + 4^k s^2,    so that s^2 = (e''^2 - e^2) / (4^k - 1).

Source: Ljung (1999), System Identification, 2nd ed., sec. 16.4 (the variance of a model's predictions);
Roache (1998), Verification and Validation in Computational Science and Engineering, ch. 5.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from hybridid.estimators.problem import Problem
from hybridid.estimators.uncertainty import jacobian_of, orthogonal
from hybridid.trace.context import Context
from hybridid.trace.refits.refitted import Refit
from hybridid.trace.trials.robustness import refitted_under

Array = NDArray[np.float64]
OF_EPSILON, OF_STEP = 4.0 / 3.0, 256.0 / 255.0
"""``4^k / (4^k - 1)`` for the orders one and four."""
OF_WIDER = 1.0 / 3.0
"""``1 / (4^k - 1)`` for the order one."""


@dataclass(frozen=True, eq=False)
class Accuracy:
    """RMS errors (n_y,) that a complete model would leave on the held-out horizons, in the outputs' units:
    of the sensors' ``noise``, of the ``parameters`` that it has moved, and of the ``simulation``."""

    noise: Array
    parameters: Array
    simulation: Array

    @classmethod
    def of(cls, final: Refit, context: Context) -> Accuracy:
        """That of ``final``, as if nothing were missing in it."""
        noise = context.noise.beside(final.score)
        return cls(noise, parameter_error(final, noise, context), simulation_error(final, context))

    @property
    def squares(self) -> Array:
        """Mean squares (n_y,) of all three together."""
        return np.asarray(self.noise**2 + self.parameters**2 + self.simulation**2)

    def times(self, rmse: Array) -> float:
        """The largest of the outputs' errors ``rmse`` (n_y,), over what a complete model would leave."""
        return _largest(rmse, np.sqrt(self.squares))

    def times_the_least(self, rmse: Array) -> float:
        """The same over what a complete model would leave whose parameters were known."""
        return _largest(rmse, np.hypot(self.noise, self.simulation))


def _largest(rmse: Array, limit: Array) -> float:
    return float(np.max(rmse / np.where(limit > 0, limit, np.finfo(float).tiny)))


def parameter_error(final: Refit, noise: Array, context: Context) -> Array:
    """The RMS error (n_y,) on the held-out horizons of the parameters of ``final``, fitted with ``noise``
    (n_y,), in the outputs' units.

    It is zero where it cannot be told: where the sensitivities grow without end, or where the fitted horizons
    do not show a parameter at all.
    """
    split, problem = context.split, final.problem(context.split)
    fitted, held_out = (
        _weighted_jacobian(problem, final, horizons) for horizons in (split.fitted, split.held_out)
    )
    nothing = np.zeros(len(noise))
    if fitted is None or held_out is None or fitted.shape[1] == 0:
        return nothing
    q, spread, _ = orthogonal(fitted)
    sigma = noise / problem.scale
    by_output = q.reshape(-1, len(noise), q.shape[1])
    middle = np.einsum("nyi,y,nyj->ij", by_output, sigma**2, by_output)
    with np.errstate(invalid="ignore"):
        carried = held_out @ spread
        squares = np.einsum("ni,ij,nj->n", carried, middle, carried).reshape(-1, len(noise)).sum(axis=0)
    if not np.isfinite(squares).all():
        return nothing
    return np.asarray(np.sqrt(squares / final.score.samples.sum(axis=0)) * problem.scale)


def _weighted_jacobian(problem: Problem, final: Refit, horizons: tuple[int, ...]) -> Array | None:
    """The Jacobian (N, n) of the weighted outputs by the scaled parameters on ``horizons``."""
    p, x0 = final.model.values(final.values), final.x0[list(horizons)]
    found = jacobian_of(problem.on(horizons), p, x0)
    scale = np.array([final.model.parameters[k].scale for k in problem.positions])
    return None if found is None else found * scale


def simulation_error(final: Refit, context: Context) -> Array:
    """The RMS error (n_y,) of the simulation of ``final`` on the held-out horizons, in the outputs' units.

    What can be simulated neither more finely nor with a wider epsilon adds nothing. Nor does a wider epsilon
    of which the refit has not converged: what that leaves too much would pass for the simulation's.
    """
    ours, here = final.numerics, final.score.rmse**2
    finer = [replace(ours, name="half the step", finer=2 * ours.finer)]
    if final.model.smooths:
        finer.append(replace(ours, name="epsilon / 2", smoothing=ours.smoothing / 2))
    by_step, *by_epsilon = refitted_under(final, finer, context, "simulated more finely")
    differences = [OF_STEP * (here - by_step.score.rmse**2)] if by_step else []
    differences += [OF_EPSILON * (here - one.score.rmse**2) for one in by_epsilon if one]
    if by_epsilon == [None]:
        wider = [replace(ours, name="epsilon x 2", smoothing=2 * ours.smoothing)]
        coarsely = refitted_under(final, wider, context, "simulated with a wider epsilon")
        differences += [OF_WIDER * (one.score.rmse**2 - here) for one in coarsely if one and one.converged]
    return np.sqrt(np.sum([np.zeros(len(here)), *(np.maximum(0.0, one) for one in differences)], axis=0))
