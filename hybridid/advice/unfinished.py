"""Which key lets a descent end that was stopped, and how many starts tell whether a valley is the lowest.

A descent that was stopped either still falls, and more iterations help; or it creeps. Then its cost has
kinks, as that of long runs with dry friction has, or one of its parameters shows next to nothing. More
iterations then gain next to nothing. A tolerance of

    t = 2 g / SLOW_SHARE

would have ended it, g being the relative decrease in ten steps.

Of n descents that ended in w valleys, the expected number of valleys that none has found is

    w (w + 1) / (n - w - 2),   n > w + 2.

It is one at n = w (w + 1) + w + 2.
Source: Boender, Rinnooy Kan (1987), Bayesian stopping rules for multistart global optimization methods,
Mathematical Programming 37, 59-80.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from hybridid.advice.advice import Advice
from hybridid.estimators.estimate import Estimate
from hybridid.estimators.findings import SAME_OPTIMUM
from hybridid.estimators.stop import SLOW_GAIN, SLOW_SHARE, SLOW_STEPS
from hybridid.quantities import percent

MORE = 4
"""Times the iterations that are proposed where the cost still falls."""
LARGEST = 1e-3
"""Tolerance that the settings allow."""
VALLEYS = 4
"""With more the cost is rough rather than divided into valleys, and no number of starts is proposed."""


def stopped(estimate: Estimate) -> Iterator[Advice]:
    """What to set where a descent of Gauss-Newton used all its iterations."""
    settings, history = estimate.settings, estimate.history
    steps = len(history) - 1
    if estimate.converged or settings.method != "gauss_newton" or steps < max(settings.max_iterations, 2):
        return
    last = max(1, steps // 2)
    fallen = history[-1 - last] / history[-1] - 1.0 if history[-1] > 0 else math.inf
    gain = fallen * SLOW_STEPS / last
    seen = f"in its last {last} iterations the cost fell by {percent(fallen, 2)}"
    tolerance = _rounded_up(2 * gain / SLOW_SHARE)
    if gain >= SLOW_GAIN or not settings.tolerance < tolerance <= LARGEST:
        most = MORE * settings.max_iterations
        yield Advice("stopped", f"{seen}: it still falls; try estimator.max_iterations={most}")
        return
    lacks = "; what the model leaves is not for more iterations to take: it lacks physics"
    more = any(one.exceeded for one in estimate.left)
    yield Advice(
        "stopped",
        f"{seen}: it creeps, and more iterations change little; estimator.tolerance={tolerance:g} counts "
        f"that as an optimum{lacks if more else ''}",
    )


def few_starts(estimate: Estimate) -> Iterator[Advice]:
    """How many starts to try where too few tell whether the valley that is kept is the lowest."""
    valleys = _valleys(estimate.starts)
    needed = valleys * (valleys + 1) + valleys + 2
    if not 1 < valleys <= VALLEYS or len(estimate.starts) >= needed:
        return
    lone = estimate.settings.starts + needed - len(estimate.starts)
    yield Advice(
        "valley",
        f"{len(estimate.starts)} starts ended in {valleys} valleys, too few to tell that the one which is "
        f"kept is the lowest; estimator.starts={lone} tells more",
    )


def _valleys(costs: tuple[float, ...]) -> int:
    """How many different costs the descents that did not diverge ended at."""
    ended = np.sort([cost for cost in costs if math.isfinite(cost)])
    if not len(ended):
        return 0
    return 1 + int(np.sum(ended[1:] > ended[:-1] * (1 + SAME_OPTIMUM)))


def _rounded_up(value: float) -> float:
    """``value`` with one digit, not less."""
    if not 0 < value < math.inf:
        return value
    digit = 10.0 ** math.floor(math.log10(value))
    return float(f"{math.ceil(value / digit) * digit:.0e}")
