"""The noise behind a residual is recovered, also where a fit has absorbed most of its slow part."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.signal import lfilter

from hybridid.estimators.absorbed import Absorbed
from hybridid.estimators.noise import noise_of
from hybridid.estimators.uncertainty import autoregression


def polynomials(length: int, degree: int) -> np.ndarray:
    """Orthonormal columns up to ``degree``, (length, degree + 1)."""
    return np.linalg.qr(np.vander(np.linspace(-1, 1, length), degree + 1))[0]


def left_by_a_fit(series: np.ndarray, horizons: int, degree: int) -> Absorbed:
    """What is left of ``series`` (N,) after a polynomial in each horizon and one wave over all of them."""
    length = len(series) // horizons
    states = np.tile(polynomials(length, degree), (horizons, 1, 1))
    pieces = series.reshape(horizons, length)
    wave = np.sin(np.arange(len(series)) / 40).reshape(horizons, length)
    residual, direction = (
        values - np.einsum("whm,wm->wh", states, np.einsum("whm,wh->wm", states, values))
        for values in (pieces, wave)
    )
    direction /= np.linalg.norm(direction)
    residual = residual - direction * np.sum(direction * residual)
    used = np.ones((horizons, length), dtype=bool)
    taken = states[:, :, None, :], direction[:, :, None, None]
    return Absorbed(residual[..., None], used, used[..., None], *taken)


@pytest.mark.parametrize("seed", range(3))
def test_white_noise_has_the_textbooks_variance(noise, seed):
    """RSS over (N - k): every direction that the fit took counts."""
    fitted = left_by_a_fit(noise(2000, 0.3, seed=seed), 100, 1)
    found = noise_of(fitted)[0]
    taken = 100 * 2 + 1
    assert found.order == 0
    assert found.variance == pytest.approx(np.sum(fitted.residual**2) / (2000 - taken), rel=0.01)
    naive = np.sum(fitted.residual**2) / 2000
    assert naive < 0.95 * found.variance


@pytest.mark.parametrize("horizons", [1, 20, 80])
def test_slow_noise_is_recovered_from_what_short_horizons_left(noise, horizons):
    """Averages over ten draws of 4000 samples, correlated over ten of them."""
    rho, variance = [], []
    naive = []
    for seed in range(10):
        fitted = left_by_a_fit(noise(4000, 1.0, 0.9, seed=seed), horizons, 1)
        found = noise_of(fitted)[0]
        gain = np.abs(1 / np.polyval(np.append(-found.coefficients[::-1], 1.0), np.exp(-0.02j))) ** 2
        rho.append(np.sum(found.coefficients))
        variance.append(found.variance * gain)
        naive.append(autoregression(list(fitted.residual[..., 0]))[0].sum())
    slow = (1 - 0.9**2) / abs(1 - 0.9 * np.exp(-0.02j)) ** 2
    assert np.mean(rho) == pytest.approx(0.9, abs=0.02)
    assert np.mean(variance) == pytest.approx(slow, rel=0.15), "power at slow frequencies"
    if horizons == 80:
        assert np.mean(naive) < 0.83, "without the correction it is lost"


def test_each_output_has_a_noise_of_its_own(noise):
    parts = [
        left_by_a_fit(noise(3000, 0.5, seed=1), 10, 1),
        left_by_a_fit(noise(3000, 2.0, 0.8, seed=2), 10, 1),
    ]

    def beside(name):
        """Each output's columns, zero at the other output."""
        first, second = (np.repeat(getattr(part, name), 2, axis=2) for part in parts)
        return np.concatenate([first * [[1], [0]], second * [[0], [1]]], axis=3)

    residual = np.concatenate([part.residual for part in parts], axis=2)
    cells = np.concatenate([part.cells for part in parts], axis=2)
    white, slow = noise_of(Absorbed(residual, parts[0].used, cells, beside("states"), beside("parameters")))
    assert white.order == 0
    assert white.variance == pytest.approx(0.25, rel=0.1)
    assert slow.coefficients[0] == pytest.approx(0.8, abs=0.05)
    assert slow.variance == pytest.approx(4 * (1 - 0.8**2), rel=0.1)


def test_padding_says_nothing(noise):
    whole = left_by_a_fit(noise(1200, 1.0, 0.7, seed=3), 6, 1)
    pad = ((0, 0), (0, 57))
    padded = Absorbed(
        np.pad(whole.residual, (*pad, (0, 0))),
        np.pad(whole.used, pad),
        np.pad(whole.cells, (*pad, (0, 0))),
        np.pad(whole.states, (*pad, (0, 0), (0, 0))),
        np.pad(whole.parameters, (*pad, (0, 0), (0, 0))),
    )
    first, second = noise_of(whole)[0], noise_of(padded)[0]
    np.testing.assert_allclose(first.coefficients, second.coefficients, rtol=1e-9)
    assert first.variance == pytest.approx(second.variance, rel=1e-9)


def test_a_residual_of_nothing_is_noise_of_nothing():
    fitted = left_by_a_fit(np.zeros(600), 6, 1)
    found = noise_of(fitted)[0]
    assert (found.order, found.variance) == (0, 0.0)


def test_an_autoregression_is_found_in_pieces(noise):
    pieces = np.split(noise(6000, 1.0, 0.85, seed=5), [500, 1300, 4000])
    coefficients, variance = autoregression(pieces)
    assert coefficients[0] == pytest.approx(0.85, abs=0.03)
    assert variance == pytest.approx(1 - 0.85**2, rel=0.06)
    assert len(coefficients) <= 3
    assert np.abs(np.roots(np.append(1.0, -coefficients))).max() < 1


def test_one_short_piece_does_not_shorten_the_memory_of_all(noise):
    """Its order is chosen by the data, not by a last horizon of a few samples."""
    shape = np.zeros(13)
    shape[0], shape[12] = 1.0, -0.9
    seasonal = lfilter([1.0], shape, np.random.default_rng(0).normal(size=6000))
    coefficients, _ = autoregression([seasonal[:5990], seasonal[5990:]])
    assert len(coefficients) >= 12
    assert coefficients[11] == pytest.approx(0.9, abs=0.03)


def test_white_series_need_no_coefficients(noise):
    coefficients, variance = autoregression([noise(4000, 2.0, seed=8)])
    assert len(coefficients) == 0
    assert variance == pytest.approx(4.0, rel=0.1)
    assert autoregression([np.zeros(100)])[1] == 0.0
