"""When one model explains held-out horizons better than another.

The test is a split-sample likelihood ratio: both models are fitted on some horizons and
their whitened Gaussian log-likelihoods compared on others, horizon by horizon. Under the
null the richer model can only overfit, so the difference is not positive on average,
whatever its parameters' bounds and whether or not its shape parameters exist under the
null. Horizons are the independent units, which is what sets the effective sample size.
Source: Cox (1975), Biometrika 62(2), 441-444 (data splitting); Vuong (1989),
Econometrica 57(2); Diebold, Mariano (1995), J. Bus. Econ. Stat. 13(3).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy import stats

from hybridid.trace.score import Score


@dataclass(frozen=True)
class Rules:
    """What a verdict needs.

    ``alpha`` bounds the probability of one false effect among all tried in a step (Holm);
    ``worth`` is the smallest decrease of held-out RMSE worth having; ``tie`` the relative
    difference of RMSE below which two effects explain the record equally well; ``vague``
    the standard error, as a share of the value, above which a parameter is not determined,
    and ``collinear`` the correlation with another parameter above which the two are one;
    ``steady`` the share of its value that a parameter may move when the numerics change, and
    ``kept`` the least share of what an effect explains that must outlive the change; ``refuted``
    how many times the error a change may leave before it counts as refuted by the records;
    ``near_floor`` how close to the noise floor nothing more can be found.
    """

    alpha: float = 0.01
    worth: float = 0.05
    tie: float = 0.02
    vague: float = 0.5
    collinear: float = 0.995
    steady: float = 0.5
    kept: float = 0.5
    refuted: float = 1.5
    near_floor: float = 1.05
    most_effects: int = 6


@dataclass(frozen=True)
class Comparison:
    """``gain`` = 1 - loss(richer) / loss(poorer) held out; ``p_value`` one-sided, richer not
    better; ``likelihood_gain`` the summed log-likelihood ratio."""

    gain: float
    p_value: float
    likelihood_gain: float


def compare(poorer: Score, richer: Score) -> Comparison:
    """Held-out evidence for ``richer`` over ``poorer``, scored on the same horizons."""
    ratio = (richer.likelihood - poorer.likelihood).sum(axis=1)
    lower = np.isfinite(richer.loss) and poorer.loss > 0
    return Comparison(
        gain=1.0 - richer.loss / poorer.loss if lower else 0.0,
        p_value=_one_sided(ratio),
        likelihood_gain=float(ratio.sum()),
    )


def _one_sided(differences: np.ndarray) -> float:
    """p-value of "the mean is not positive" (Student's t over horizons)."""
    if not np.isfinite(differences).all():
        return 1.0
    if np.ptp(differences) == 0:
        return 0.0 if differences[0] > 0 else 1.0
    return float(stats.ttest_1samp(differences, 0.0, alternative="greater").pvalue)


def holm(p_values: Sequence[float]) -> list[float]:
    """Adjusted p-values: the family-wise error over all tried. Source: Holm (1979)."""
    order = np.argsort(p_values)
    count, running, adjusted = len(p_values), 0.0, [1.0] * len(p_values)
    for rank, k in enumerate(order):
        running = max(running, (count - rank) * p_values[k])
        adjusted[k] = min(running, 1.0)
    return adjusted
