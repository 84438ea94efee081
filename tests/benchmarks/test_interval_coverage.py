"""The study of intervals runs, and its arithmetic is right; its numbers come from ``make study-coverage``."""

from __future__ import annotations

import pytest

from benchmarks import interval_coverage as script


def test_a_row_counts_what_the_intervals_hold():
    """Errors of 1, 2 and 3 under a standard error of 1, of which 0.4 is noise."""
    draws = [script.Draw([float(k)] * 4, [1.0] * 4, [0.4] * 4, True) for k in (1, 2, 3)]
    row = script.rows(script.CASES[0], draws)[0]
    assert (row.parameter, row.unit) == ("M", "kg")
    assert row.held == pytest.approx(1 / 3)
    assert row.held_by_noise_alone == 0.0
    assert (row.bias, row.scatter) == (pytest.approx(2.0), pytest.approx(1.0))
    assert "33% | 0%" in script.table([row], 3)


@pytest.mark.parametrize("index", range(5))
def test_every_case_runs_and_finds_the_truth(index):
    case = script.CASES[index]
    made = script.measure(case, 2.0, seed=1)
    assert made.simulated
    assert (made.outputs != script.measure(case, 2.0, seed=2).outputs).mean() > 0.9
    draw = script.study(case, 2.0, seed=1)
    assert draw.converged
    assert abs(draw.error[0]) < 1.0, "mass in kg"
    assert all(0 < noise <= std for noise, std in zip(draw.noise, draw.std, strict=True))


def test_slow_noise_is_as_loud_as_it_says():
    import numpy as np

    case = script.CASES[1]
    made = script.noise(case, 200_000, np.random.default_rng(0))
    assert made.std() == pytest.approx(case.std, rel=0.05)
    lag = round(case.memory / script.DT)
    assert np.corrcoef(made[lag:], made[:-lag])[0, 1] == pytest.approx(np.exp(-1), abs=0.05)
