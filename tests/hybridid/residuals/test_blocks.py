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
