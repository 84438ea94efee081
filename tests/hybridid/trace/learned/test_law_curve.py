"""Which efforts are a curve over a variable: only these can take over a part of a learned effort."""

from __future__ import annotations

import numpy as np
import pytest

from hybridid.trace.learned.law_curve import LEAST, ONE_CURVE, _share, binned

GENERATOR = np.random.default_rng(7)
VELOCITY, ACCELERATION = GENERATOR.standard_normal((2, 4000))
ONE = np.ones_like(VELOCITY)


@pytest.mark.parametrize(
    ("effort", "factor", "curve"),
    [
        (3.0 * VELOCITY, ONE, True),
        (np.tanh(50 * VELOCITY), ONE, True),
        (ONE, ONE, True),
        (0.0 * ONE, ONE, True),
        (ACCELERATION, ONE, False),
        (ACCELERATION, ACCELERATION, True),
        (VELOCITY * ACCELERATION, ACCELERATION, True),
        (VELOCITY, ACCELERATION, False),
    ],
    ids=["viscous", "coulomb", "constant", "none", "inertia", "inertia a", "v a", "viscous over a"],
)
def test_an_effort_is_a_curve_if_it_follows_from_the_variable_and_the_factor(effort, factor, curve):
    share = _share(effort, binned(VELOCITY, effort, factor), VELOCITY, factor)
    assert (share >= ONE_CURVE) == curve


def test_a_bin_with_few_samples_is_not_shown():
    seen = np.append(np.linspace(0.0, 1.0, 1000), 2.0)
    curve = binned(seen, 2.0 * seen, np.ones_like(seen))
    assert curve.at.max() <= 1.0
    assert curve.samples.min() >= LEAST
    assert curve.value == pytest.approx(2.0 * curve.at)


def test_a_short_record_has_fewer_bins():
    curve = binned(VELOCITY[:200], 3.0 * VELOCITY[:200], ONE[:200])
    assert len(curve.at) >= 3
    assert _share(3.0 * VELOCITY[:200], curve, VELOCITY[:200], ONE[:200]) >= ONE_CURVE


def test_without_any_factor_there_is_no_curve():
    nothing = 0.0 * ONE
    curve = binned(VELOCITY, VELOCITY, nothing)
    assert len(curve.at) == 0
    assert _share(VELOCITY, curve, VELOCITY, nothing) == pytest.approx(0.0)
