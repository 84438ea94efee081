"""Choice of a network without the validation record: blocks of the fitted records are held out in turn.

Each record is cut into contiguous blocks. One block after the other is left out: gray box and network are
fitted to the rest, and the block is simulated free-run from its own estimated initial state. The choice
is the smallest network whose error is within one standard error of the lowest. Source:
Hastie, Tibshirani, Friedman (2009), The Elements of Statistical Learning, sec. 7.10.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from itertools import starmap
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hybridid.estimators.fit import fit
from hybridid.model import Model
from hybridid.records.record import Record
from hybridid.residuals.choice import smallest_within
from hybridid.residuals.rbf_fit import RBFPlan, fit_rbf
from hybridid.settings.fit import FitSettings
from hybridid.simulation.simulate import Diverged
from hybridid.validation.predict import free_run

Array = NDArray[np.float64]
Mapper = Callable[[Callable[..., Any], Iterable[tuple[Any, ...]]], Iterable[Any]]
"""``mapper(function, argument tuples)`` gives results in order: ``itertools.starmap`` or a process pool."""
SHORTEST = 50
"""Smallest number of samples in a block."""
RULE = (
    "the fewest nodes whose error on held-out blocks of the fitted records is within one standard error "
    "of the lowest; among those the lowest"
)


@dataclass(frozen=True, eq=False)
class Fold:
    """Parts of the records that are fitted, and those that are held out."""

    fitted: tuple[Record, ...]
    held_out: tuple[Record, ...]


@dataclass(frozen=True)
class Candidate:
    """A network plan and its fit settings."""

    plan: RBFPlan
    settings: FitSettings


@dataclass(frozen=True, eq=False)
class FoldScore:
    """Mean square errors (n_y,) on a fold's held-out blocks: of the gray box and with the network.

    ``failure`` is the reason why there are none, such as a simulation that diverges.
    """

    gray: Array
    hybrid: Array
    failure: str = ""


@dataclass(frozen=True, eq=False)
class Scored:
    """A candidate on all folds. ``spread`` (n_y,) are the outputs' standard deviations."""

    candidate: Candidate
    folds: tuple[FoldScore, ...]
    spread: Array

    @property
    def gray_rmse(self) -> Array:
        """RMS error of the gray box fitted without each block, (n_y,), in the outputs' units."""
        return np.sqrt(np.mean([f.gray for f in self.folds], axis=0))

    @property
    def rmse(self) -> Array:
        """RMS error of the hybrid, (n_y,), in the outputs' units; infinite if it failed on a fold."""
        return np.sqrt(np.mean([f.hybrid for f in self.folds], axis=0))

    @property
    def by_fold(self) -> Array:
        """Each fold's mean square error over the outputs' variances, (folds,)."""
        return np.array([np.mean(f.hybrid / self.spread**2) for f in self.folds])

    @property
    def score(self) -> float:
        """Mean of ``by_fold``: mean square error over the outputs' variances; infinite after a failure."""
        return float(self.by_fold.mean())

    @property
    def standard_error(self) -> float:
        """Standard error of ``score`` over the folds."""
        return (
            float(self.by_fold.std(ddof=1) / np.sqrt(len(self.folds))) if np.isfinite(self.score) else np.inf
        )


def folds(records: Sequence[Record], count: int) -> list[Fold]:
    """``count`` folds; each leaves out one contiguous block of every record.

    Raises:
        ValueError: if there are fewer than 2, or a block would be too short.
    """
    if count < 2:
        raise ValueError(f"residual.folds is {count}: at least 2")
    shortest = min(records, key=lambda r: r.n)
    if shortest.n < count * SHORTEST:
        raise ValueError(f"residual.folds is {count}: record {shortest.name} has only {shortest.n} samples")
    return [_fold(records, k, count) for k in range(count)]


def _fold(records: Sequence[Record], index: int, count: int) -> Fold:
    fitted, held_out = [], []
    for record in records:
        edges = np.linspace(0, record.n, count + 1).astype(int)
        first, end = int(edges[index]), int(edges[index + 1])
        held_out.append(record.part(first, end, f"{record.name} block {index + 1}"))
        if first > 0:
            fitted.append(record.part(0, first, f"{record.name} before block {index + 1}"))
        if end < record.n:
            fitted.append(record.part(end, record.n, f"{record.name} after block {index + 1}"))
    return Fold(tuple(fitted), tuple(held_out))


@dataclass(frozen=True, eq=False)
class Alone:
    """The gray box fitted without a fold's held-out blocks: its parameters, and its mean square errors
    (n_y,) on those blocks. ``failure`` says why there are none."""

    values: dict[str, float]
    square: Array
    failure: str = ""


def fit_alone(gray: Model, fold: Fold, settings: FitSettings) -> Alone:
    """Fit the gray box to the fitted parts of the fold and simulate its held-out blocks."""
    values = fit(gray, fold.fitted, settings).values
    try:
        return Alone(values, _mean_square(gray, values, fold, settings))
    except Diverged as failure:
        return Alone(values, np.full(len(gray.outputs), np.inf), str(failure))


def score_fold(gray: Model, fold: Fold, candidate: Candidate, alone: Alone) -> FoldScore:
    """Fit the network beside the gray box to the fitted parts and simulate the held-out blocks."""
    nothing = np.full(len(gray.outputs), np.inf)
    if alone.failure:
        return FoldScore(alone.square, nothing, alone.failure)
    try:
        found = fit_rbf(gray, alone.values, fold.fitted, candidate.plan, candidate.settings)
        square = _mean_square(found.model, found.estimate.values, fold, candidate.settings)
        return FoldScore(alone.square, square)
    except (Diverged, ValueError) as failure:
        return FoldScore(alone.square, nothing, str(failure))


def _mean_square(model: Model, values: dict[str, float], fold: Fold, settings: FitSettings) -> Array:
    errors = [free_run(model, values, r, "estimated", settings.integrator).error for r in fold.held_out]
    return np.nanmean(np.concatenate(errors) ** 2, axis=0)


def compare(
    gray: Model,
    records: Sequence[Record],
    candidates: Sequence[Candidate],
    gray_settings: FitSettings,
    count: int = 4,
    mapper: Mapper = starmap,
) -> list[Scored]:
    """All candidates on the same ``count`` folds of ``records``; the gray box is fitted once a fold."""
    cut = folds(records, count)
    alone = list(mapper(fit_alone, [(gray, fold, gray_settings) for fold in cut]))
    jobs = [
        (gray, fold, candidate, fitted)
        for candidate in candidates
        for fold, fitted in zip(cut, alone, strict=True)
    ]
    scores = list(mapper(score_fold, jobs))
    spread = np.nanstd(np.concatenate([r.counted for r in records]), axis=0)
    spread[spread == 0] = 1.0
    return [
        Scored(candidate, tuple(scores[k * count : (k + 1) * count]), spread)
        for k, candidate in enumerate(candidates)
    ]


def choose(scored: Sequence[Scored]) -> Scored:
    """The plan with the fewest nodes within one standard error of the lowest held-out error.

    Raises:
        ValueError: if every candidate failed.
    """
    best = min(scored, key=lambda s: s.score)
    if not np.isfinite(best.score):
        reasons = {f.failure for s in scored for f in s.folds if f.failure}
        raise ValueError(f"no network can be chosen: every one failed ({'; '.join(sorted(reasons))})")
    nodes = [s.candidate.plan.nodes for s in scored]
    return scored[smallest_within([s.score for s in scored], nodes, best.score + best.standard_error)]
