"""Fewer points, the same picture."""

from __future__ import annotations

import numpy as np
import pytest

from hybridid.plotting.thinning import broken, extremes, thin


@pytest.mark.parametrize("n", [10, 1204, 1205, 24841, 100_003])
def test_no_extreme_of_any_stretch_is_lost(n):
    y = np.random.default_rng(0).standard_normal(n).cumsum()
    y[n // 3] += 1e4
    kept = extremes(y, 600)
    assert len(kept) <= 1204
    assert np.all(np.diff(kept) > 0)
    assert kept[0] == 0
    assert kept[-1] == n - 1
    size = -(-n // 600)
    for start in range(0, n, size):
        inside = y[kept[(kept >= start) & (kept < start + size)]]
        assert inside.max() == y[start : start + size].max()
        assert inside.min() == y[start : start + size].min()


def test_what_is_not_finite_leaves_a_gap_and_takes_nothing_with_it():
    y = np.ones(10_000)
    y[5000:] = np.inf
    y[4990] = 7.0
    y[2001] = np.nan
    x, kept = thin(np.arange(10_000.0), y, 100)
    assert np.all(np.isfinite(kept[x < 5000]))
    assert 7.0 in kept
    assert np.isnan(kept[x >= 5000]).all()


def test_a_line_breaks_before_each_start_but_the_first():
    x, y = np.arange(6.0), np.arange(6.0)
    broken_x, broken_y = broken(x, y, np.array([0.0, 2.0, 4.0]))
    assert np.flatnonzero(np.isnan(broken_y)).tolist() == [2, 5]
    assert broken_x.tolist() == [0, 1, 2, 2, 3, 4, 4, 5]
