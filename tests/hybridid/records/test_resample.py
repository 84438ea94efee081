"""Resampling keeps what it can: smooth signals within the method's order, held inputs' integral exactly."""

from __future__ import annotations

import numpy as np
import pytest

from hybridid.records.record import RecordError
from hybridid.records.resample import Resample, resampled


def jittered(n: int, dt: float, seed: int, amount: float = 0.4) -> np.ndarray:
    jitter = np.random.default_rng(seed).uniform(-amount * dt, amount * dt, n)
    jitter[[0, -1]] = 0.0
    return np.arange(n) * dt + jitter


def staircase_integral(time: np.ndarray, values: np.ndarray, at: np.ndarray) -> np.ndarray:
    """∫ from time[0] of the signal that holds values[k] from time[k] on."""
    found = np.searchsorted(time, at, side="right") - 1
    before = np.concatenate([[0.0], np.cumsum(values[:-1] * np.diff(time))])
    return before[found] + values[found] * (at - time[found])


@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize(("method", "order"), [("linear", 2), ("pchip", 2)])
def test_the_error_of_a_smooth_signal_falls_with_the_step(seed, method, order):
    errors = []
    for n in (200, 400):
        dt = 1.0 / (n - 1)
        time = jittered(n, dt, seed)
        grid, (values,), _ = resampled(time, [np.sin(9 * time)], [None], Resample(dt, method), "r")
        errors.append(np.abs(values - np.sin(9 * grid)).max())
    assert errors[0] < 3e-3
    assert errors[1] < errors[0] / 2 ** (order - 0.6)


@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize("dt", [0.7e-3, 1e-3, 2.3e-3])
def test_a_held_input_keeps_its_integral(seed, dt):
    """The impulse that drives the machine up to every grid point is the recorded one."""
    time = jittered(500, 1e-3, seed)
    force = np.random.default_rng(seed).normal(size=500)
    grid, (held,), _ = resampled(time, [force], ["zoh"], Resample(dt), "r")
    got = np.concatenate([[0.0], np.cumsum(held * dt)])[:-1]
    np.testing.assert_allclose(got, staircase_integral(time, force, grid), atol=1e-12)
    assert held.min() >= force.min() - 1e-12
    assert held.max() <= force.max() + 1e-12


def test_lines_through_a_staircase_would_be_early():
    """Why held inputs are treated apart: a step up at 0.1 s must not begin before it."""
    time = np.arange(0, 0.2, 0.01)
    step = (time > 0.095).astype(float)
    grid, (held, line), _ = resampled(time, [step, step], ["zoh", "foh"], Resample(0.002, "linear"), "r")
    assert held[grid < 0.0999].max() == pytest.approx(0.0, abs=1e-12)
    assert line[grid < 0.0999].max() > 0.5


@pytest.mark.parametrize("hold", ["zoh", "foh", "bandlimited", None])
def test_an_even_record_stays_what_it_is(hold):
    time = 0.3 + np.arange(300) * 1e-3
    values = np.random.default_rng(0).normal(size=300)
    grid, (same,), warnings = resampled(time, [values], [hold], Resample(1e-3), "r")
    assert len(grid) == 300
    np.testing.assert_allclose(grid, time, atol=1e-12)
    np.testing.assert_allclose(same, values, atol=1e-9)
    assert len(warnings) == 1


def test_the_grid_is_even_and_ends_within_the_record():
    time = jittered(501, 1e-3, seed=1)
    grid, _, _ = resampled(time, [time], [None], Resample(0.8e-3), "r")
    np.testing.assert_allclose(np.diff(grid), 0.8e-3, rtol=1e-9)
    assert grid[0] == time[0]
    assert time[-1] - 0.8e-3 < grid[-1] <= time[-1] + 1e-9


def test_pchip_does_not_overshoot():
    time = jittered(100, 1e-2, seed=3)
    step = (time > 0.5).astype(float)
    _, (values,), _ = resampled(time, [step], [None], Resample(1e-3), "r")
    assert values.min() >= 0.0
    assert values.max() <= 1.0


def test_a_coarser_grid_is_warned_of():
    time = np.arange(300) * 1e-3
    _, _, warnings = resampled(time, [time], [None], Resample(5e-3), "record r")
    assert any("folds high frequencies down; resample to 0.001 s and decimate instead" in w for w in warnings)


@pytest.mark.parametrize(("shift", "said"), [(-1e-3, "repeats"), (-3e-3, "runs backward")])
def test_time_that_does_not_advance_cannot_be_resampled(shift, said):
    time = np.arange(300) * 1e-3
    time[40] += shift
    with pytest.raises(RecordError, match=said):
        resampled(time, [time], [None], Resample(1e-3), "r")


def test_an_impossible_step():
    with pytest.raises(RecordError, match="resample: dt is -1 s"):
        Resample(-1.0)


def test_what_stands_still_stays_still():
    time = np.cumsum(np.random.default_rng(0).uniform(0.003, 0.007, 500))
    _, found, _ = resampled(time, [np.full(500, 200.0)] * 3, ["zoh", "foh", None], Resample(0.005), "r")
    assert all(np.array_equal(one, np.full_like(one, 200.0)) for one in found)
