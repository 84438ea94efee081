"""Training and held-out windows never share a sample."""

from __future__ import annotations

import numpy as np
import pytest

from hybridid.residuals.blocks import blocks


def covered(starts, horizon, reach):
    """Every sample that a window touches, past ones included."""
    return {int(s) + k for s in starts for k in range(-reach, horizon)}


@pytest.mark.parametrize(("horizon", "reach"), [(1, 3), (25, 7)])
def test_windows_are_apart(horizon, reach):
    split = blocks([(0, 1000), (1000, 1700)], count=10, held_out=0.2)
    train = covered(split.starts(horizon, reach), horizon, reach)
    check = covered(split.checks(horizon, reach), horizon, reach)
    assert train
    assert check
    assert not train & check
    # no window runs from one record into the next
    assert all(not {999, 1000} <= set(range(s - reach, s + horizon)) for s in split.starts(horizon, reach))


def test_the_share_is_kept_and_spread():
    split = blocks([(0, 1000)], count=10, held_out=0.2)
    assert split.held_out == ((200, 300), (700, 800))
    assert split.train == ((0, 200), (300, 700), (800, 1000))


def test_checks_lie_side_by_side():
    starts = blocks([(0, 1000)], 10, 0.1).checks(horizon=20, reach=5)
    assert set(np.diff(starts)) == {20}


def test_no_window_touches_a_gap():
    gaps = np.zeros(1000, dtype=bool)
    gaps[[50, 250, 251, 999]] = True
    whole = blocks([(0, 1000)], count=10, held_out=0.2)
    split = whole.without(gaps)
    assert split.held_out == ((200, 250), (252, 300), (700, 800))
    assert split.train == ((0, 50), (51, 200), (300, 700), (800, 999))
    assert not covered(split.starts(20, 5), 20, 5) & {50, 250, 251, 999}
    assert whole.without(np.zeros(1000, dtype=bool)) is whole
