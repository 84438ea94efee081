"""Adjustments and changes of sign against counting them all, and comparisons whose answer is known."""

from __future__ import annotations

from dataclasses import replace
from itertools import combinations, product

import numpy as np
import pytest
from scipy.signal import lfilter
from statsmodels.stats.multitest import multipletests

from hybridid.estimators.noise import MOST_LAGS
from hybridid.trace.horizons.evidence import _by_t, by_signs, compare, holm
from hybridid.trace.horizons.score import BLOCKS, score_of

HORIZONS, LENGTH = 24, 200


@pytest.mark.parametrize("seed", range(5))
def test_holm_is_holm(seed):
    p = np.random.default_rng(seed).uniform(size=17) ** 4
    assert holm(list(p)) == pytest.approx(multipletests(p, method="holm")[1])


@pytest.mark.parametrize("seed", range(5))
def test_weights_share_the_error_that_is_allowed(seed):
    """Weighted Holm closes the weighted Bonferroni test: what is adjusted fails in no set that it is in."""
    generator = np.random.default_rng(seed)
    p, w = generator.uniform(size=6) ** 4, generator.uniform(size=6)
    sets = [s for size in range(1, 7) for s in combinations(range(6), size)]
    of_sets = {s: min(p[j] * sum(w[list(s)]) / w[j] for j in s) for s in sets}
    closed = [min(1.0, max(of_sets[s] for s in sets if k in s)) for k in range(6)]
    assert holm(list(p), list(w)) == pytest.approx(closed)


def test_what_does_nothing_where_it_is_fitted_takes_no_share():
    assert holm([0.004, 1e-9], [1.0, 0.0]) == [0.004, 1.0]
    assert holm([0.004, 1e-9], [0.0, 0.0]) == [1.0, 1.0]


@pytest.mark.parametrize("seed", range(5))
def test_every_change_of_sign_is_counted(seed):
    """Sizes are rounded down, so a little more than the changes whose sum is as large."""
    differences = np.random.default_rng(seed).normal(0.5, 1.0, 12)
    signs = np.array(list(product((-1, 1), repeat=12)))
    counted = np.mean(signs @ np.abs(differences) >= differences.sum() - 1e-12)
    found = by_signs(alternated(differences))
    assert counted <= found <= counted + 2e-3


def alternated(differences):
    """The same differences in an order without positive autocorrelation: large and small by turns."""
    ranked = np.sort(differences)
    half = len(ranked) // 2
    return np.stack([ranked[:half], ranked[: half - 1 : -1]], axis=1).ravel()


def test_an_effect_that_acts_now_and_then_is_seen():
    """Large gains in every fifth block, small losses in the others: t takes the scatter for noise."""
    generator = np.random.default_rng(3)
    differences = -0.1 * generator.uniform(size=60)
    differences[::5] = 10.0 ** generator.uniform(1, 4, size=12)
    t = differences.mean() / differences.std(ddof=1) * np.sqrt(60)
    assert t < 3
    assert by_signs(differences) < 1e-3


def test_one_large_gain_is_one_sign():
    differences = np.full(40, -1e-3)
    differences[20] = 100.0
    assert by_signs(differences) > 0.4


def errors(std, seed, bias=0.0):
    generator = np.random.default_rng(seed)
    return [bias + generator.normal(0, std, (LENGTH, 1)) for _ in range(HORIZONS)]


def test_a_better_model_is_found_better():
    poor = score_of(errors(2.0, 0), errors(2.0, 1), np.ones(1))
    rich = score_of(errors(1.0, 0), errors(1.0, 1), np.ones(1))
    evidence = compare(poor, rich)
    assert evidence.gain == pytest.approx(0.5, abs=0.02)
    assert evidence.p_value < 1e-12
    assert compare(rich, poor).p_value > 0.999


def test_half_the_comparisons_of_equals_favour_either():
    """Under the null the p-value is not small more often than it says."""
    p = [
        compare(
            score_of(errors(1.0, s), errors(1.0, 500 + s), np.ones(1)),
            score_of(errors(1.0, 1000 + s), errors(1.0, 1500 + s), np.ones(1)),
        ).p_value
        for s in range(200)
    ]
    assert np.mean(np.array(p) < 0.05) < 0.1


@pytest.mark.parametrize("memory", [0.2, 1.0, 4.0])
def test_blocks_of_errors_with_a_memory_are_not_significant_more_often_than_they_say(memory):
    """The squares of two errors, equal on the average, that remember for ``memory`` blocks."""
    blocks, samples, draws = 48, 20, 4000
    generator, keeps = np.random.default_rng(2), np.exp(-1 / (memory * samples))
    white = generator.normal(size=(2, draws, blocks * samples + 500))
    both, one = lfilter([np.sqrt(1 - keeps**2)], [1, -keeps], white)[..., 500:]
    differences = ((both + 0.5 * one) ** 2 - (both - 0.5 * one) ** 2).reshape(draws, blocks, samples).mean(2)
    assert np.mean([_by_t(each) < 0.01 for each in differences]) < 0.015


def test_one_lucky_horizon_is_not_significant():
    """Horizons are the independent units: a gain that one of them makes says little."""
    rows = errors(1.0, 1)
    rows[7] = rows[7] + 30.0
    poor, rich = (score_of(errors(1.0, 0), held, np.ones(1)) for held in (rows, errors(1.0, 1)))
    evidence = compare(poor, rich)
    assert evidence.gain > 0.8
    assert evidence.p_value > 0.1


def test_one_horizon_that_both_miss_does_not_hide_the_others():
    """A horizon far worse than all others makes the mean square, and its scatter, alone."""
    rows, better = errors(1.0, 1), errors(0.6, 2)
    for held in (rows, better):
        held[7] = 50.0 * np.sin(np.arange(LENGTH) / 9.0)[:, None] + held[7]
    better[7] = 0.9 * better[7]
    evidence = compare(score_of(rows, rows, np.ones(1)), score_of(rows, better, np.ones(1)))
    assert evidence.gain > 0.05
    assert evidence.p_value < 1e-4


def test_what_is_not_finite_gains_nothing():
    fine = score_of(errors(1.0, 0), errors(1.0, 1), np.ones(1))
    broken = replace(
        fine, squares=np.full_like(fine.squares, np.inf), likelihood=np.full_like(fine.likelihood, -np.inf)
    )
    evidence = compare(fine, broken)
    assert (evidence.gain, evidence.p_value) == (0.0, 1.0)


def test_coloured_errors_are_whitened(noise):
    """The same errors, coloured: likelihood judges innovations, so twice the error is found in either."""
    coloured = [noise(LENGTH, 1.0, 0.95, seed)[:, None] for seed in range(2 * HORIZONS)]
    half = [0.5 * row for row in coloured]
    evidence = compare(
        score_of(coloured[:HORIZONS], coloured[HORIZONS:], np.ones(1)),
        score_of(half[:HORIZONS], half[HORIZONS:], np.ones(1)),
    )
    assert evidence.gain == pytest.approx(0.5)
    expected = HORIZONS * (LENGTH - min(MOST_LAGS, LENGTH // 4)) * np.log(2)
    assert evidence.likelihood_gain == pytest.approx(expected, rel=0.02)


def test_slow_errors_count_though_whitening_looks_away(noise):
    """An autoregression predicts a slow error from its past; that the error halves is evidence."""
    slow = [noise(LENGTH, 1.0, 0.999, seed)[:, None] for seed in range(2 * HORIZONS)]
    white = [1e-2 * row for row in errors(1.0, 1) + errors(1.0, 2)]
    poor, rich = ([s * part + w for s, w in zip(slow, white, strict=True)] for part in (1.0, 0.5))
    judged = [score_of(rows[:HORIZONS], rows[HORIZONS:], np.ones(1)) for rows in (poor, rich)]
    assert compare(*judged).p_value < 1e-3


def test_horizons_that_follow_each_other_count_less():
    """The same gains in long runs of like horizons are worth fewer of them."""
    base = score_of(errors(1.0, 0), errors(1.0, 1), np.ones(1), blocks=1)
    gains = np.random.default_rng(2).normal(0.4, 1.0, HORIZONS)
    likelihood = {"mixed": gains, "runs": np.sort(gains)}
    p = {
        name: compare(base, replace(base, likelihood=base.likelihood + g[:, None])).p_value
        for name, g in likelihood.items()
    }
    assert p["runs"] > 2 * p["mixed"]


def test_the_order_of_the_whitening_changes_no_count(noise):
    """Errors alike but for their colour, whose autoregressions differ in order, in a unit that makes a
    sample's log-density large: neither model is favoured by having fewer samples counted."""
    white = [1e-6 * row for row in errors(1.0, 4) + errors(1.0, 5)]
    coloured = [1e-6 * noise(LENGTH, 1.0, 0.9, 40 + k)[:, None] for k in range(2 * HORIZONS)]
    gained = [
        compare(
            score_of(a[:HORIZONS], a[HORIZONS:], np.ones(1)), score_of(b[:HORIZONS], b[HORIZONS:], np.ones(1))
        )
        for a, b in ((white, coloured), (coloured, white))
    ]
    innovations = np.sqrt(1 - 0.9**2)
    expected = HORIZONS * (LENGTH - min(MOST_LAGS, LENGTH // 4)) * np.log(1 / innovations)
    assert gained[0].likelihood_gain == pytest.approx(expected, rel=0.05)
    assert gained[1].likelihood_gain == pytest.approx(-expected, rel=0.05)


@pytest.mark.filterwarnings("error")
def test_errors_as_large_as_numbers_go_are_compared_in_silence():
    """A model may leave the record by 10^160 on a held-out horizon and not diverge."""
    fitted, small = errors(1.0, 0), errors(1.0, 1)
    huge = [*small[:-1], np.full_like(small[-1], 1e152)]
    scale = np.full(1, 1e-3)
    found = compare(score_of(fitted, small, scale), score_of(fitted, huge, scale))
    assert found.p_value == 1.0
    assert found.gain == 0.0


def parts_of_a_long_row(gained):
    """Six long horizons each of a poorer and a richer model; the errors that fall are ``gained`` (6, 480)."""
    noise = np.random.default_rng(7).normal(size=(12, 480))
    poorer = noise[6:] + gained
    return [list(rows[..., None]) for rows in (noise[:6], poorer, noise[6:])]


def test_a_few_long_horizons_are_judged_by_their_blocks():
    """A gain in every part of six horizons: six are too few for a hundred candidates, blocks are not."""
    slow = 0.5 * np.sin(np.arange(480) / 9.0)
    fitted, before, after = parts_of_a_long_row(slow)
    by_units = [
        compare(*(score_of(fitted, held, np.ones(1), blocks) for held in (before, after))).p_value
        for blocks in (1, BLOCKS)
    ]
    assert by_units[0] > 1e-4
    assert by_units[1] < 1e-6


def test_a_gain_in_one_of_a_few_horizons_is_not_many_gains():
    """The blocks of one lucky horizon follow each other, and count as few."""
    lucky = np.zeros((6, 480))
    lucky[2] = 2.0
    fitted, before, after = parts_of_a_long_row(lucky)
    assert compare(*(score_of(fitted, held, np.ones(1)) for held in (before, after))).p_value > 0.01


def test_a_short_horizon_is_not_divided_into_nothing():
    rows = [row[:12] for row in errors(1.0, 3)[:6]]
    score = score_of(rows, rows, np.ones(1))
    assert score.likelihood.shape == (6, 1)
    assert np.isfinite(score.likelihood).all()


def test_a_sample_counts_for_the_outputs_that_were_measured():
    """Of two outputs one is logged at every second sample, and in one horizon not at all."""
    generator = np.random.default_rng(3)
    whole = generator.normal(size=(4, HORIZONS, LENGTH, 2))
    cells = np.ones((HORIZONS, LENGTH, 2), dtype=bool)
    cells[:, 1::2, 1] = cells[2, :, 1] = False
    fitted, held = ([np.where(c, e, 0.0) for c, e in zip(cells, part, strict=True)] for part in whole[:2])
    found = score_of(fitted, held, np.ones(2), cells=(list(cells), list(cells)))
    assert found.samples[2].tolist() == [LENGTH, 0]
    assert found.rmse == pytest.approx([1.0, 1.0], rel=0.1)
    # each output as if it had been recorded alone, at its own rate
    slow = [[row[::2, 1:] for k, row in enumerate(part) if k != 2] for part in (fitted, held)]
    alone = score_of(*slow, np.ones(1))
    measured = np.arange(HORIZONS) != 2
    assert found.squares[measured, 1:] == pytest.approx(alone.squares)
    assert found.likelihood[:, 1].sum() == pytest.approx(alone.likelihood.sum())
    better = [np.where(c, 0.5 * e, 0.0) for c, e in zip(cells, held, strict=True)]
    richer = score_of(fitted, better, np.ones(2), cells=(list(cells), list(cells)))
    assert compare(found, richer).gain == pytest.approx(0.5)
    assert compare(found, richer).p_value < 1e-6
