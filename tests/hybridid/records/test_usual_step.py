"""The usual step of uneven stamps: a grid of it meets them to the end."""

from __future__ import annotations

import numpy as np
import pytest

from hybridid.records.usual_step import UsualStep, in_digits, usual_step


def rounded(step, decimals, n=3000, lost=(5, 6, 7, 100, 2000)):
    """Stamps of an even clock, rounded; some are missing."""
    return np.delete(np.round(5.0 + step * np.arange(n), decimals), lost)


@pytest.mark.parametrize("decimals", [2, 3, 5])
@pytest.mark.parametrize(
    ("step", "written"),
    [
        (1 / 30, 0.0333333333333),  # a whole rate
        (1001 / 30000, 0.033367),  # that of television, which a grid of 1/30 s leaves
        (0.02, 0.02),
    ],
)
def test_a_grid_of_the_step_meets_rounded_stamps_to_the_end(step, written, decimals):
    time = rounded(step, decimals)
    found = usual_step(time)
    assert in_digits([found]) == written
    numbers = np.rint((time - time[0]) / step)
    assert np.abs(time - time[0] - found.seconds * numbers).max() <= 10.0**-decimals


def test_a_clock_that_slipped_now_and_then_keeps_its_whole_rate():
    """As the measured stamps of a video: one step in a hundred is 5 % longer."""
    time = np.arange(289) / 30 + (1 / 600) * (np.arange(289) // 100)
    assert in_digits([usual_step(time)]) == 0.0333333333333


def test_stamps_that_follow_no_clock_have_their_median_to_two_digits():
    steps = 0.02 + np.random.default_rng(1).normal(0, 2e-3, 2000).clip(-0.01, 0.01)
    found = usual_step(np.cumsum(steps))
    assert found.seconds == np.median(np.diff(np.cumsum(steps)))
    assert in_digits([found]) == 0.02


def test_several_recordings_have_one_step_that_all_allow():
    one, other = UsualStep(0.033348, 3e-5), UsualStep(0.03332, 2e-5)
    assert in_digits([one, other]) == 0.0333333333333
    assert in_digits([UsualStep(0.01, 1e-6), UsualStep(0.02, 1e-6)]) == 0.01, "the shortest, if none does"


def test_stamps_that_stand_still_have_a_step():
    assert in_digits([usual_step(np.zeros(5))]) == 0.0
