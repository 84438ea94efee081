"""The swept sine and the slope of an encoder's angle."""

from __future__ import annotations

import numpy as np
import pytest

from hybridid.rigs.laws import RigError
from hybridid.rigs.sweep import LinearSweep, VelocityFilter


def test_a_sweep_goes_on_at_its_last_frequency():
    sweep = LinearSweep(amplitude=0.3, first=0.1, last=5.0, duration=10.0)
    t = np.linspace(10.0, 10.4, 401)
    assert sweep.position(t) == pytest.approx(0.3 * np.sin(2 * np.pi * (25.5 + 5.0 * (t - 10.0))), abs=1e-12)
    step = np.diff(sweep.position(np.array([10 - 1e-6, 10.0, 10 + 1e-6])))
    assert step[0] == pytest.approx(step[1], rel=1e-4)


def test_the_slope_of_a_polynomial_is_exact_and_noise_is_what_its_weights_make_of_it():
    t = 2e-3 * np.arange(-2, 103)
    angle = 0.3 + 0.2 * t - 4.0 * t**2 + 30.0 * t**4
    assert VelocityFilter()(angle, 2e-3) == pytest.approx((0.2 - 8.0 * t + 120.0 * t**3)[2:-2], abs=1e-9)
    noise = VelocityFilter()(np.random.default_rng(0).standard_normal(50_000), 1.0)
    assert noise.std() == pytest.approx(np.sqrt(130) / 12, rel=0.02)  # (1, -8, 0, 8, -1) / 12


@pytest.mark.parametrize(
    ("make", "said"),
    [
        (lambda: LinearSweep(1.0, 5.0, 1.0, 10.0), "frequencies must rise"),
        (lambda: LinearSweep(1.0, 1.0, 5.0, 0.0), "duration must be above 0"),
        (lambda: VelocityFilter(window=4), "must be odd"),
        (lambda: VelocityFilter(window=5, degree=5), "longer than the degree"),
    ],
)
def test_what_cannot_be_is_refused(make, said):
    with pytest.raises(RigError, match=said):
        make()
