"""When one model explains held-out horizons better than another.

The test is a split-sample likelihood ratio: both models are fitted on some horizons and
their whitened Gaussian log-likelihoods compared on others, horizon by horizon. Under the
null the richer model can only overfit, so the difference is not positive on average,
whatever its parameters' bounds and whether or not its shape parameters exist under the
null. Horizons are the units; their autocorrelation sets how many count as independent.

The likelihoods are compared by their signs, not by Student's t: an effect that acts now and then (a limit, a
stop) makes a few differences large, which increases the variance in the denominator of t.

Whitening removes slow errors, which an autoregression predicts from their own past. So
the squared errors themselves are compared as well (Diebold, Mariano), and their logarithms, in which
one block that is far worse than the others cannot outweigh them. Of the three p-values the smallest
counts, three times (Bonferroni).
Source: Cox (1975), Biometrika 62(2), 441-444 (data splitting); Vuong (1989),
Econometrica 57(2); Diebold, Mariano (1995), J. Bus. Econ. Stat. 13(3).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import stats

from hybridid.trace.horizons.score import Score

Array = NDArray[np.float64]
MOST_GROUPS = 48
"""Of differences whose signs are changed: all alike, they reach a p-value of 2^-48."""
CELLS = 1 << 14
"""Steps between no sum and the largest, in which the changes of sign are counted."""


@dataclass(frozen=True)
class Comparison:
    """``gain`` = 1 - loss(richer) / loss(poorer) held out; ``p_value`` one-sided, richer not
    better; ``likelihood_gain`` the summed log-likelihood ratio of the whitened errors. ``largest`` is the
    gain in the RMSE of the output that gains most: where a poor sensor makes most of the loss, it hides what
    a good one shows."""

    gain: float
    p_value: float
    likelihood_gain: float
    largest: float = 0.0


@np.errstate(over="ignore", invalid="ignore")  # held-out errors of a model that nearly diverges
def compare(poorer: Score, richer: Score) -> Comparison:
    """Held-out evidence for ``richer`` over ``poorer``, scored on the same horizons."""
    ratio = (richer.likelihood - poorer.likelihood).sum(axis=1)
    p_values = (
        by_signs(ratio),
        _by_t(_of_squares(poorer, richer)),
        _by_t(_of_logarithms(poorer, richer)),
    )
    lower = np.isfinite(richer.loss) and poorer.loss > 0
    return Comparison(
        gain=1.0 - richer.loss / poorer.loss if lower else 0.0,
        p_value=min(1.0, len(p_values) * min(p_values)),
        likelihood_gain=float(ratio.sum()),
        largest=_largest_gain(poorer, richer) if lower else 0.0,
    )


def _largest_gain(poorer: Score, richer: Score) -> float:
    """By which share the RMSE of the output that gains most falls."""
    before, after = poorer.rmse, richer.rmse
    return float(np.max(1.0 - after[before > 0] / before[before > 0], initial=0.0))


def _of_squares(poorer: Score, richer: Score) -> Array:
    """By how much each block's squared errors fall, over the outputs' variances, (b,)."""
    return np.asarray(((poorer.block_squares - richer.block_squares) / poorer.scale**2).sum(axis=1))


def _of_logarithms(poorer: Score, richer: Score) -> Array:
    """By how much the logarithm of each block's mean square error falls, (b,): its mean over the outputs
    that were measured there. A block without any error says nothing."""
    before, after = (_mean_squares(score) for score in (poorer, richer))
    both = (before > 0) | (after > 0)
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.where(both, np.log(before) - np.log(after), 0.0)


def _mean_squares(score: Score) -> Array:
    """Mean square error of each block, (b,), over the outputs' variances."""
    measured = score.block_samples > 0
    by_output = score.block_squares / np.maximum(score.block_samples, 1) / score.scale**2
    return np.asarray(by_output.sum(axis=1) / np.maximum(measured.sum(axis=1), 1))


def by_signs(differences: Array) -> float:
    """p-value of "the differences (n,) are not positive": how often is their sum as large with random signs?

    If the richer model is no better, a difference is as likely negative as positive, however large; so the
    sizes may differ from place to place. Neighbours that go together are summed first, as ``_independent``
    counts. The sums are counted in ``CELLS``, sizes rounded down: p is never too small.
    Source: Fisher (1935), The Design of Experiments, sec. 21; Hemerik, Goeman, Finos (2020), J. R. Stat. Soc.
    B 82(3), 841-864.
    """
    if not np.isfinite(differences).all() or len(differences) < 2:
        return 1.0
    independent = int(_independent(len(differences), _autocorrelation(differences)))
    groups = np.array_split(differences, max(2, min(MOST_GROUPS, independent)))
    sums = np.array([group.sum() for group in groups])
    sizes, total = np.abs(sums), float(np.abs(sums).sum())
    if total == 0 or sums.sum() <= 0:
        return 1.0
    negative = -float(sums[sums < 0].sum())
    share = np.zeros(int(CELLS * negative / total) + 1)
    share[0] = 1.0
    for step in (CELLS * sizes / total).astype(int):
        kept = share / 2
        if step < len(share):
            kept[step:] += share[: len(share) - step] / 2
        share = kept
    return float(share.sum())


def _by_t(differences: Array) -> float:
    """p-value of "the mean is not positive": Student's t, (n,) blocks that count as ``_independent``.

    Of few blocks the autocorrelation r_1 is estimated too small, by about (1 + 3 r_1) / n. That is added.
    Source: Kendall (1954), Biometrika 41(3/4), 403-404.
    """
    if not np.isfinite(differences).all() or len(differences) < 2:
        return 1.0
    rest = differences - differences.mean()
    spread = float(rest @ rest)
    if spread <= np.finfo(float).eps * float(differences @ differences):
        return 0.0 if differences[0] > 0 else 1.0
    first, n = _autocorrelation(differences), len(differences)
    independent = _independent(n, min(1.0, first + (1 + 3 * first) / n))
    t = differences.mean() / np.sqrt(spread / (n - 1) / independent)
    return float(stats.t.sf(t, independent - 1))


def _independent(n: int, r: float) -> float:
    """How many of ``n`` blocks with the autocorrelation ``r`` at one block's distance count as independent,

        n (1 - r) / (1 + r),  at least two.

    Source: Bayley, Hammersley (1946), J. R. Stat. Soc. Suppl. 8(2), 184-197.
    """
    return max(n * (1 - r) / (1 + r), 2.0)


def _autocorrelation(differences: Array) -> float:
    """Of neighbours among ``differences`` (n,), if it is positive; else zero."""
    rest = differences - differences.mean()
    spread = float(rest @ rest)
    rounding = np.finfo(float).eps * float(differences @ differences)
    return max(0.0, float(rest[1:] @ rest[:-1]) / spread) if spread > rounding else 0.0


def holm(p_values: Sequence[float], weights: Sequence[float] | None = None) -> list[float]:
    """Adjusted p-values: the family-wise error over all tried.

    The error allowed is shared in proportion to ``weights`` (None: equally). They must not depend on the data
    behind ``p_values``. What has the weight zero is never significant.
    Source: Holm (1979), Scand. J. Stat. 6(2), 65-70; Genovese, Roeder, Wasserman (2006), Biometrika 93(3),
    509-524.
    """
    w = np.ones(len(p_values)) if weights is None else np.asarray(weights, dtype=float)
    over = np.divide(p_values, w, out=np.full(len(w), np.inf), where=w > 0)
    left, running, adjusted = float(w.sum()), 0.0, [1.0] * len(w)
    for k in (k for k in np.argsort(over, kind="stable") if w[k] > 0):
        running = max(running, float(over[k]) * left)
        adjusted[k] = min(running, 1.0)
        left -= float(w[k])
    return adjusted
