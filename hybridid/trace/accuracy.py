"""How near the error that is left comes to the smallest error that a complete model could leave.

Two things separate a complete model from the measured output: the sensor's noise, and the simulation's error.
The simulation's error has two causes: friction at rest is smoothed to tanh(v/epsilon), so the model creeps
where the machine sticks, and the integrator's step has a finite length. The error s of the simulation is
found by Richardson's extrapolation, from the held-out errors e before, and e' after all
is refitted with epsilon / 2 or with half the step. With r from other causes, and a method of order k,

    e^2 = r^2 + s^2,    e'^2 = r^2 + s^2 / 4^k,    so that s^2 = (e^2 - e'^2) 4^k / (4^k - 1).

The order is one in epsilon and four in the step of RK4. Where the finer simulation leaves no smaller error, s
is taken as zero.

Source: Roache (1998), Verification and Validation in Computational Science and Engineering, ch. 5.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from hybridid.trace.context import Context
from hybridid.trace.refit import Refit, refit_if_possible

Array = NDArray[np.float64]
OF_EPSILON, OF_STEP = 4.0 / 3.0, 256.0 / 255.0
"""``4^k / (4^k - 1)`` for the orders one and four."""


def simulation_error(final: Refit, context: Context) -> Array:
    """The RMS error (n_y,) of the simulation of ``final`` on the held-out horizons, in the outputs' units.

    A finer simulation that is not possible adds nothing.
    """
    ours, split = final.numerics, context.split
    finer = [(OF_STEP, replace(ours, name="half the step", finer=2 * ours.finer))]
    if final.model.smooths:
        finer.append((OF_EPSILON, replace(ours, name="epsilon / 2", smoothing=ours.smoothing / 2)))
    given = [(final.model, split, [final.values], final, numerics) for _, numerics in finer]
    squares = np.zeros(len(final.model.outputs))
    for (factor, _), again in zip(finer, context.mapper(refit_if_possible, given), strict=True):
        if again is not None:
            squares += factor * np.maximum(0.0, final.score.rmse**2 - again.score.rmse**2)
    return np.sqrt(squares)


def times_the_limit(rmse: Array, noise: Array, simulation: Array) -> float:
    """The largest of the outputs' errors (n_y,), over what noise and simulation alone would leave."""
    limit = np.hypot(noise, simulation)
    return float(np.max(rmse / np.where(limit > 0, limit, np.finfo(float).tiny)))
