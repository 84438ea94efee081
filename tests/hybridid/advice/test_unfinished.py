"""What is advised where a descent was stopped, or few starts ended in several valleys."""

from __future__ import annotations

import numpy as np
import pytest

from hybridid.advice.unfinished import few_starts, stopped
from hybridid.estimators import FitSettings
from hybridid.estimators.estimate import Estimate, Left
from hybridid.estimators.stop import SLOW_SHARE, SLOW_STEPS

LACKING = Left("y", "m", 1.0, 0.1, 0.0, 0.0, np.nan, True)


def ended(history=(), converged=False, starts=(), left=(), **settings):
    return Estimate(
        (), {}, np.empty((0, 0)), np.empty((0, 0)), (), history[-1] if history else 1.0, "stopped", converged,
        len(history), {}, 1, FitSettings(**settings), tuple(history), starts, left=left,
    )  # fmt: skip


def said(found):
    return [one.said for one in found]


def descent(share, steps=100, least=1.0):
    """A cost that falls by ``share`` of itself at each of ``steps``, down to ``least``."""
    return (least * (1 + share) ** np.arange(steps, -1, -1.0)).tolist()


def test_a_descent_that_creeps_is_told_the_tolerance_that_would_have_ended_it():
    (line,) = said(stopped(ended(descent(4e-6), left=(LACKING,))))
    assert line.startswith("in its last 50 iterations the cost fell by 0.02 %: it creeps")
    tolerance = float(line.partition("estimator.tolerance=")[2].split()[0])
    assert SLOW_STEPS * 4e-6 < SLOW_SHARE * tolerance < 3 * SLOW_STEPS * 4e-6
    assert line.endswith("it lacks physics")
    (without,) = said(stopped(ended(descent(4e-6))))
    assert "physics" not in without


def test_a_descent_that_still_falls_is_told_to_go_on():
    (line,) = said(stopped(ended(descent(1e-2), max_iterations=100)))
    assert line.endswith("it still falls; try estimator.max_iterations=400")
    # a tolerance that is large already would not have ended it
    (line,) = said(stopped(ended(descent(5e-5), tolerance=1e-3)))
    assert line.endswith("try estimator.max_iterations=400")


@pytest.mark.parametrize(
    "estimate",
    [
        ended(descent(4e-6), converged=True),
        ended(descent(4e-6, steps=20)),  # it ended otherwise
        ended(descent(4e-6), method="multiple_shooting"),
        ended(),
    ],
)
def test_nothing_is_said_where_it_was_not_stopped(estimate):
    assert said(stopped(estimate)) == []


def test_two_valleys_of_two_starts_want_eight_more():
    (line,) = said(few_starts(ended(starts=(1.0, 2.0))))
    assert "2 starts ended in 2 valleys" in line
    assert "estimator.starts=9 " in line  # and the second descent of every fit


@pytest.mark.parametrize(
    "costs",
    [
        (),
        (1.0,),
        (1.0, 1.0005),
        (1.0, np.inf),
        (1.0, 1.0, 1.0, 1.0, 2.0, 2.0, 2.0, 1.0, 1.0, 2.0),  # ten starts, two valleys
        (1.0, 2.0, 3.0, 4.0, 5.0),  # a rough cost
    ],
)
def test_enough_starts_or_a_rough_cost_want_no_more(costs):
    assert said(few_starts(ended(starts=costs))) == []
