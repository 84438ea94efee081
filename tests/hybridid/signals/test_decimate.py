"""Fewer samples of the same signal: nothing folds, nothing shifts, a held input keeps its impulse."""

from __future__ import annotations

import numpy as np
import pytest

from hybridid.signals.decimate import Decimate
from hybridid.signals.step import StepError


@pytest.mark.parametrize("factor", [2, 5, 10, 13])
@pytest.mark.parametrize("hold", ["foh", "bandlimited"])
def test_what_the_new_rate_can_show_is_kept_where_it_was(record_of, factor, hold):
    f = 0.75 * 500 / factor  # Hz, within the pass band

    def sine(t: np.ndarray) -> np.ndarray:
        return 0.3 + np.sin(2 * np.pi * f * t + 1)

    record = record_of(y=sine, u=sine, hold=hold, n=8000)
    coarse = Decimate(factor).apply(record)
    assert coarse.n == 8000 // factor
    assert coarse.dt == pytest.approx(factor * 1e-3, rel=1e-9)
    assert coarse.time[0] == record.time[0]
    settled = slice(60, -60)
    for values in (coarse.output("position"), coarse.input("force"), coarse.signal("reference") - 1):
        np.testing.assert_allclose(values[settled], sine(coarse.time)[settled], atol=3e-4)


@pytest.mark.parametrize("factor", [2, 5, 10])
@pytest.mark.parametrize("beyond", [1.02, 1.5, 1.98])
def test_what_it_cannot_show_is_gone(record_of, factor, beyond):
    f = beyond * 500 / factor
    record = record_of(y=lambda t: np.sin(2 * np.pi * f * t), n=8000)
    settled = slice(60, -60)
    assert np.abs(Decimate(factor).apply(record).output("position")[settled]).max() < 3e-4
    folded = Decimate(factor, anti_alias=False).apply(record).output("position")[settled]
    assert np.abs(folded).max() > 0.5


@pytest.mark.parametrize("factor", [2, 8, 10])
def test_a_position_keeps_its_level_and_slope_to_the_ends(record_of, factor):
    """scipy.signal.decimate would return 0.2472 m for 0.25 m."""
    record = record_of(y=lambda t: 0.25 + 0.1 * t)
    coarse = Decimate(factor).apply(record)
    np.testing.assert_allclose(coarse.output("position"), 0.25 + 0.1 * coarse.time, atol=1e-6)


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("factor", [2, 7, 10])
def test_a_held_input_keeps_its_impulse(record_of, seed, factor):
    noise = np.random.default_rng(seed).normal(size=2000)
    coarse = Decimate(factor).apply(record_of(u=lambda t: noise))
    fine_impulse = np.concatenate([[0.0], np.cumsum(noise) * 1e-3])[::factor][: coarse.n]
    coarse_impulse = np.concatenate([[0.0], np.cumsum(coarse.input("force")) * factor * 1e-3])[: coarse.n]
    np.testing.assert_allclose(coarse_impulse, fine_impulse, atol=1e-12)


def test_the_coarse_record_drives_a_machine_as_the_fine_one_did(record_of):
    """M v' = F - f_v v under a command that changes every sample: the held mean is what the machine felt."""
    m, f_v, n, factor = 90.0, 200.0, 20000, 10
    force = 100 * np.random.default_rng(0).normal(size=n)

    def driven(u: np.ndarray, dt: float) -> np.ndarray:
        a = np.exp(-f_v / m * dt)
        v = np.zeros(len(u))
        for k in range(len(u) - 1):
            v[k + 1] = a * v[k] + (1 - a) / f_v * u[k]
        return v

    fine = record_of(y=lambda t: driven(force, 1e-3), u=lambda t: force, n=n)
    exact = driven(force, 1e-3)[::factor]

    def error(u: np.ndarray) -> float:
        return float(np.sqrt(np.mean((driven(u, factor * 1e-3) - exact) ** 2)))

    held = error(Decimate(factor).apply(fine).input("force"))
    picked = error(force[::factor])
    assert held < 0.02 * np.std(exact)
    assert held < picked / 50


def test_too_short_and_too_small(record_of):
    with pytest.raises(StepError, match=r"record bench has 200 samples, too few to decimate by 10: .* 2\d\d"):
        Decimate(10).apply(record_of(n=200))
    with pytest.raises(StepError, match="factor is 1, it must be at least 2"):
        Decimate(1)
