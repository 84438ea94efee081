"""The noise level beside a model: the smaller of two upper bounds, and no less than the rounding."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.signal import lfilter

from hybridid.records.sensor_noise import noise_level
from hybridid.trace.horizons.noise import Noise
from hybridid.trace.horizons.score import score_of

SIGMA = 1e-3


def rows(seed, share, n=40, samples=250):
    """White noise of ``SIGMA`` and ``share`` as much of a resonance of nine samples a period."""
    rng = np.random.default_rng(seed)
    pole = 0.98 * np.exp(2j * np.pi / 9)
    swing = lfilter([1.0], np.poly([pole, pole.conj()]).real, rng.normal(size=n * samples + 500))[500:]
    errors = rng.normal(0, SIGMA, n * samples) + share * SIGMA * swing / swing.std()
    return [row[:, None] for row in errors.reshape(n, samples)]


def beside(share, show=1.0, rounding=0.0):
    score = score_of(rows(1, share), rows(2, share), np.ones(1))
    return float(Noise(np.array([show]), np.array([rounding])).beside(score)[0]), float(score.rmse[0])


def test_white_errors_are_noise():
    level, rmse = beside(0.0)
    assert level == pytest.approx(SIGMA, rel=0.03)
    assert level == pytest.approx(rmse, rel=0.03)


@pytest.mark.parametrize(("share", "most"), [(3.0, 0.5), (10.0, 0.35)])
def test_a_resonance_that_a_model_leaves_is_no_noise(share, most):
    level, rmse = beside(share)
    assert rmse > 0.9 * share * SIGMA
    assert SIGMA < level < most * rmse, "an upper bound, and a far lower one than the error"


def test_the_smaller_bound_counts_but_no_less_than_the_rounding():
    assert beside(3.0, show=1.1 * SIGMA)[0] == 1.1 * SIGMA
    assert beside(0.0, rounding=2 * SIGMA)[0] == 2 * SIGMA


def test_a_few_jerks_do_not_raise_it():
    errors = rows(2, 0.0)
    errors[7] = errors[7] * 100
    score = score_of(rows(1, 0.0), errors, np.ones(1))
    assert score.innovation[0] == pytest.approx(SIGMA, rel=0.06)
    assert score.rmse[0] > 10 * SIGMA


def test_a_record_shows_its_noise_where_it_is_smooth(split_of):
    split = split_of()
    noise = Noise.of(split.records)
    assert noise.show == pytest.approx(np.max([noise_level(r) for r in split.records], axis=0))
    assert (noise.rounding <= noise.show).all()
