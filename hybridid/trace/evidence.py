"""When one model explains held-out horizons better than another.

The test is a split-sample likelihood ratio: both models are fitted on some horizons and
their whitened Gaussian log-likelihoods compared on others, horizon by horizon. Under the
null the richer model can only overfit, so the difference is not positive on average,
whatever its parameters' bounds and whether or not its shape parameters exist under the
null. Horizons are the units; their autocorrelation sets how many count as independent.

Whitening looks away from slow errors, which an autoregression predicts from their own past. So
the squared errors themselves are compared as well (Diebold, Mariano), and their logarithms, in which
one horizon that is far worse than the others cannot outweigh them. Of the three p-values the smallest
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

from hybridid.trace.score import Score

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Comparison:
    """``gain`` = 1 - loss(richer) / loss(poorer) held out; ``p_value`` one-sided, richer not
    better; ``likelihood_gain`` the summed log-likelihood ratio of the whitened errors."""

    gain: float
    p_value: float
    likelihood_gain: float


def compare(poorer: Score, richer: Score) -> Comparison:
    """Held-out evidence for ``richer`` over ``poorer``, scored on the same horizons."""
    ratio = (richer.likelihood - poorer.likelihood).sum(axis=1)
    tested = (ratio, _of_squares(poorer, richer), _of_logarithms(poorer, richer))
    lower = np.isfinite(richer.loss) and poorer.loss > 0
    return Comparison(
        gain=1.0 - richer.loss / poorer.loss if lower else 0.0,
        p_value=min(1.0, len(tested) * min(map(_one_sided, tested))),
        likelihood_gain=float(ratio.sum()),
    )


def _of_squares(poorer: Score, richer: Score) -> Array:
    """By how much each horizon's squared errors fall, over the outputs' variances, (h,)."""
    return np.asarray(((poorer.squares - richer.squares) / poorer.scale**2).sum(axis=1))


def _of_logarithms(poorer: Score, richer: Score) -> Array:
    """By how much the logarithm of each horizon's mean square error falls, (h,)."""
    before, after = ((s.squares / s.samples / s.scale**2).mean(axis=1) for s in (poorer, richer))
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.asarray(np.log(before) - np.log(after))


def _one_sided(differences: Array) -> float:
    """p-value of "the mean is not positive": Student's t over units (n,), horizons or blocks, of which

        n (1 - r) / (1 + r)

    count as independent, r their autocorrelation at one unit's distance if it is positive. Source:
    Bayley, Hammersley (1946), J. R. Stat. Soc. Suppl. 8(2), 184-197.
    """
    if not np.isfinite(differences).all() or len(differences) < 2:
        return 1.0
    rest = differences - differences.mean()
    spread = float(rest @ rest)
    if spread <= np.finfo(float).eps * float(differences @ differences):
        return 0.0 if differences[0] > 0 else 1.0
    count = len(differences)
    r = max(0.0, float(rest[1:] @ rest[:-1]) / spread)
    independent = max(count * (1 - r) / (1 + r), 2.0)
    t = differences.mean() / np.sqrt(spread / (count - 1) / independent)
    return float(stats.t.sf(t, independent - 1))


def holm(p_values: Sequence[float]) -> list[float]:
    """Adjusted p-values: the family-wise error over all tried. Source: Holm (1979)."""
    order = np.argsort(p_values)
    count, running, adjusted = len(p_values), 0.0, [1.0] * len(p_values)
    for rank, k in enumerate(order):
        running = max(running, (count - rank) * p_values[k])
        adjusted[k] = min(running, 1.0)
    return adjusted
