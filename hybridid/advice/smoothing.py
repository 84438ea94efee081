"""Whether the smoothing of sign(v) makes most of what a fit leaves, and how narrow an epsilon would do.

What the smoothing leaves is about proportional to epsilon. So epsilon is halved as often as it takes for that
error to be as small as the sensor's noise, ``MOST_HALVINGS`` times at most.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

from hybridid.advice.advice import Advice
from hybridid.estimators.estimate import Estimate, Left
from hybridid.estimators.floor import FAR, MISFIT
from hybridid.estimators.problem import Problem
from hybridid.naming import listed
from hybridid.quantities import quantity

MOST_HALVINGS = 4
"""Of each epsilon: a sixteenth takes up to sixteen times as many steps."""


def wide_smoothing(problem: Problem, estimate: Estimate) -> Iterator[Advice]:
    """Which epsilons to try where an output is more than ``FAR`` times its noise from the record, and the
    smoothing makes most of that squared error."""
    blurred = [one for one in estimate.left if _mostly_smoothing(one)]
    widths = [problem.model.parameters[k] for k in problem.widths]
    if not blurred or not widths:
        return
    needed = max(math.ceil(math.log2(one.smeared / one.noise)) for one in blurred)
    halvings = min(needed, MOST_HALVINGS)
    made = listed(
        [f"{_said(one, one.smeared)} of the {_said(one, one.rmse)} left of {one.output}" for one in blurred]
    )
    settings = " ".join(f"+parameters.{q.name}.guess={q.guess / 2**halvings:.2g}" for q in widths)
    yield Advice(
        "smoothing",
        f"sign(v) is smoothed so widely that this alone makes {made}; where the machine truly sticks, "
        f"{settings} leaves less. A trace narrows it by itself",
    )


def _said(one: Left, error: float) -> str:
    return quantity(error, one.unit, 2)


def _mostly_smoothing(one: Left) -> bool:
    """Whether it is far above a noise that is told, by the smoothing."""
    return one.noise > 0 and one.rmse > FAR * one.noise and MISFIT * one.smeared >= one.rmse
