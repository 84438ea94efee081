"""A hypothesis tried: the same model fitted again, to pieces of the records as the hypothesis has them.

It explains what the fit leaves if it leaves less than half of the squared error, and if it is the better one
stretch by stretch: by Clarke's test of two models that do not nest, a sign test of their log-likelihoods. Its
unit is a stretch of the record here, since residuals of neighbouring samples are alike.

With an input in the place of an output the model predicts another signal. Signals are not predicted with the
same ease: that of an integral hardly leaves its tangent. So such a hypothesis must leave less than half of
what straight lines leave too, and less than half of what the fit leaves in that measure.

Source: Clarke (2007), "A simple distribution-free test for nonnested model selection", Political Analysis
15(3), 347-363.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.stats import binom

from hybridid.estimators.descent import descend
from hybridid.estimators.plan import Descent, Handover, Refinement, Start
from hybridid.estimators.problem import Problem
from hybridid.estimators.start import at_rest, best_initial_states
from hybridid.estimators.stop import Stop
from hybridid.quality.hypotheses import Hypothesis
from hybridid.simulation.stability import MOST, substeps_wanted
from hybridid.simulation.windows import Windows, cut

Array = NDArray[np.float64]
MOST_OF = 0.5
"""Share of the squared error that an explanation leaves at most: it takes the larger part."""
ALPHA = 1e-3
"""Probability that two models that explain alike are told apart."""
STRETCHES = 50
MARGIN = 1.1
"""Steps a sample in hand: parameters move."""
LOOK, ENOUGH = Stop(3, 1e-3), Stop(40, 1e-4)
PLAN = Descent(
    handover=Handover(0, LOOK),
    refinement=Refinement(0, Handover(0, LOOK), must_hold=True),
    stop=ENOUGH,
    screening=LOOK,
)


@dataclass(frozen=True)
class Data:
    """Records as a ``problem`` whose outputs count in what doing nothing leaves of them, with the initial
    states (w, n_x) that they show."""

    problem: Problem
    shown: Array

    @classmethod
    def of(cls, problem: Problem) -> Data:
        """The records of ``problem`` over its horizons."""
        counted = replace(problem, scale=_of_nothing(problem.windows))
        return cls(counted, counted.measured_x0())

    def under(self, hypothesis: Hypothesis, p: Array) -> Data:
        """The same as ``hypothesis`` has it, in steps that are stable at ``p`` (n_p,)."""
        old, model = self.problem, hypothesis.loosened(self.problem.model)
        records = tuple(map(hypothesis.applied, old.records))
        steps = min(substeps_wanted(model, p, records, MARGIN, old.shooter.integrator), MOST)
        windows = cut(records, old.windows.horizon, steps)
        windows = windows.select([k for k, one in enumerate(windows.origin) if one in old.windows.origin])
        shooter = old.shooter.over(windows)
        return Data.of(replace(old, model=model, records=records, windows=windows, shooter=shooter))


@dataclass(frozen=True)
class Trial:
    """Where a fit of ``data`` ended: parameters ``p`` (n_p,), initial states ``x0`` (w, n_x), and the share
    that it leaves of what doing nothing leaves, in all and by stretches (infinite: it diverges). ``of_lines``
    is the share of what a straight line through each output leaves, over the horizons."""

    hypothesis: Hypothesis | None
    data: Data
    p: Array
    x0: Array
    share: float
    shares: Array
    of_lines: float

    def explains(self, other: Trial) -> bool:
        """Whether it explains most of what ``other`` leaves, and most of the motion."""
        other_outputs = self.hypothesis is not None and self.hypothesis.other_outputs
        if other_outputs and not self.of_lines < MOST_OF * min(other.of_lines, 1.0):
            return False
        return self.share < MOST_OF and explains((self.share, self.shares), (other.share, other.shares))


def explains(ours: tuple[float, Array], theirs: tuple[float, Array]) -> bool:
    """Whether of two fits' errors, in all and stretch by stretch, ``ours`` are less than half of ``theirs``,
    and not by chance."""
    if not (np.isfinite(ours[0]) and ours[0] < MOST_OF * theirs[0]):
        return False
    better = int(np.sum(ours[1] < theirs[1]))
    return bool(binom.sf(better - 1, len(ours[1]), 0.5) < ALPHA)


def tried(
    data: Data, starts: Sequence[Array], hypothesis: Hypothesis | None = None, most: float = np.inf
) -> Trial:
    """``data`` fitted from one of ``starts`` (n_p,) after the other, until one leaves less than the share
    ``most``; a descent that does not promise that ends early."""
    problem, found = data.problem, []
    half = 0.5 * problem.windows.samples * len(problem.scale)
    for p in starts:
        candidates = [data.shown, at_rest(problem, data.shown)]
        start = Start(problem, p, best_initial_states(problem, p, candidates))
        found.append(descend([start], replace(PLAN, hopeful=most * half)).solution)
        if np.isfinite(most) and found[-1].cost < most * half:
            break
    best = found[int(np.argmin([one.cost for one in found]))]
    residual = problem.residuals(problem.shooter(best.x0, best.p))
    shares = stretches(residual, problem.windows.used)
    return Trial(hypothesis, data, best.p, best.x0, best.cost / half, shares, _of_lines(problem, residual))


def stretches(residual: Array, used: NDArray[np.bool_]) -> Array:
    """Mean squares of a residual (w, H, n_y) in up to ``STRETCHES`` stretches."""
    with np.errstate(over="ignore", invalid="ignore"):
        squares = (residual**2).mean(axis=2)[used]
    parts = np.array_split(squares, min(STRETCHES, len(squares)))
    return np.array([part.mean() for part in parts])


def _of_lines(problem: Problem, residual: Array) -> float:
    """Mean squares of a weighted ``residual`` (w, H, n_y), each output's over what straight lines leave of
    it."""
    windows = problem.windows
    with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
        left = (residual**2).sum(axis=(0, 1)) / windows.counts * problem.scale**2
        return float(np.mean(np.nan_to_num(left / _straight(windows), nan=np.inf)))


def _straight(windows: Windows) -> Array:
    """Mean squares (n_y,) of the outputs about the straight line through each horizon."""
    used = windows.cells
    time = np.broadcast_to(np.arange(used.shape[1], dtype=float)[:, None], used.shape)
    moved, run = _about_mean(windows.outputs, used), _about_mean(time, used)
    size = np.maximum((run**2).sum(axis=1, keepdims=True), 1.0)
    slope = (run * moved).sum(axis=1, keepdims=True) / size
    return np.asarray(((moved - slope * run) ** 2).sum(axis=(0, 1)) / windows.counts)


def _about_mean(values: Array, used: NDArray[np.bool_]) -> Array:
    """``values`` (w, H, n_y) less their mean over what is ``used`` of each horizon, 0 where it is not."""
    count = np.maximum(used.sum(axis=1, keepdims=True), 1)
    mean = np.where(used, values, 0.0).sum(axis=1, keepdims=True) / count
    return np.where(used, values - mean, 0.0)


def _of_nothing(windows: Windows) -> Array:
    """RMS (n_y,) of the outputs about the mean of each horizon: what a constant leaves."""
    moved = _about_mean(windows.outputs, windows.cells)
    rms = np.sqrt((moved**2).sum(axis=(0, 1)) / windows.counts)
    return np.where(rms > 0, rms, 1.0)
