"""Whether a fit leaves more than the sensor's noise and the simulation would leave of a complete model.

Where the record tells its noise, the error left is compared with it: more than ``FAR`` times the noise and
the error of the simulation together is more than they leave. Where it does not (a filter has shaped the
noise, or the motion is as fast as the samples), the noise is at least as loud at rest as in motion. What a
model lacks is louder where the machine moves. So the residual is whitened by an autoregression, and its
power is compared with the motion, stretch by stretch, in a rank test. White innovations of any stationary
noise pass it.

Source: Breusch, Pagan (1979), Econometrica 47(5), 1287-1294, whose test for a variance that follows known
variables this is, with ranks in place of moments (Spearman); trace's own limit ``FAR``
(hybridid.trace.rules).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.signal import lfilter
from scipy.stats import spearmanr

from hybridid.estimators.noise import autoregression
from hybridid.estimators.problem import Problem
from hybridid.records.sensor_noise import sensor_noise
from hybridid.simulation.shooter import Shot
from hybridid.simulation.windows import in_parts

Array = NDArray[np.float64]
FAR = 3.0
"""Times what noise and simulation leave together that a complete model may leave."""
MISFIT = 2**0.5
"""Times the noise above which most of the squared error that a model leaves is its own."""
ALPHA = 1e-3
"""Probability that the rank test calls noise of any one model's outputs louder in motion."""
STRETCHES, FEWEST = 50, 10
"""Stretches of the record that are compared; fewer than the latter say nothing."""
CLEARLY = 0.8
"""Of the noise that a record tells: a fit that leaves less shows that the noise is no more than what it
leaves. A motion as fast as the samples looks like noise."""
RK4_ORDER, EXACT = 4, 1e-9
"""Order by which half the step lessens its error; an error over the output's spread that is arithmetic."""


@dataclass(frozen=True)
class Floor:
    """Of each output, in its unit: the RMS error ``left``, what the initial state could still take apart;
    the sensor's ``noise`` where the records tell it, else nan; the error of the ``simulation``: the smoothing
    of sign(v) and the length of the ``step``, which is also given alone. ``louder`` (n_y,) are the p-values
    of the rank test, nan where the noise is told. ``spread`` is the output's standard deviation."""

    left: Array
    noise: Array
    simulation: Array
    step: Array
    louder: Array
    spread: Array

    @property
    def times(self) -> Array:
        """The error left over what noise and simulation leave, (n_y,); nan where the noise is not told."""
        limit = np.hypot(self.noise, self.simulation)
        return self.left / np.where(limit > 0, limit, EXACT * self.spread)

    @property
    def exceeded(self) -> NDArray[np.bool_]:
        """Which outputs (n_y,) the fit leaves more of."""
        beyond_simulation = self.left > FAR * np.maximum(self.simulation, EXACT * self.spread)
        told = np.isfinite(self.noise)
        return beyond_simulation & np.where(told, self.times > FAR, self.louder < ALPHA / len(self.louder))


def floor_of(
    problem: Problem,
    p: Array,
    x0: Array,
    smeared: Array,
    residual: Array | None = None,
    shot: Shot | None = None,
) -> Floor:
    """The floor of ``problem`` at ``p`` (n_p,), ``x0`` (w, n_x); ``smeared`` (n_y,) is what the smoothing of
    sign(v) leaves (``Uncertainty.smeared``); ``residual`` and ``shot`` as for ``uncertainty``."""
    shot = shot or problem.shooter(x0, p, sensitivities=not problem.estimate_x0)
    residual = problem.residuals(shot) if residual is None else residual
    if not problem.estimate_x0:
        residual = _less_initial_states(problem, shot, residual)
    told = [sensor_noise(record) for record in problem.records]
    noise = np.array(
        [
            max(n.level for n in of_one) if all(n.told for n in of_one) else np.nan
            for of_one in zip(*told, strict=True)
        ]
    )
    step = _rms(problem, _by_step(problem, p, x0, shot)) * problem.scale
    left = _rms(problem, residual) * problem.scale
    return Floor(
        left=left,
        noise=np.where(left < CLEARLY * noise, left, noise),
        simulation=np.hypot(smeared, step),
        step=step,
        louder=_louder(problem, shot, residual, np.flatnonzero(np.isnan(noise))),
        spread=problem.scale,
    )


def _rms(problem: Problem, error: Array) -> Array:
    return np.sqrt((error**2).sum(axis=(0, 1)) / problem.windows.counts)


def _by_step(problem: Problem, p: Array, x0: Array, shot: Shot) -> Array:
    """The error (w, H, n_y) of the step's length, weighted: by Richardson, from steps of half the length."""
    windows, outputs = problem.windows, problem.finer_outputs(x0, p)
    error = (outputs - shot.outputs) / problem.scale * 2**RK4_ORDER / (2**RK4_ORDER - 1)
    return np.where(windows.cells & np.isfinite(error), error, 0.0)


def _less_initial_states(problem: Problem, shot: Shot, residual: Array) -> Array:
    """``residual`` without what other initial states would take, to first order: where they are not
    estimated, their error is no fault of the model."""
    found = np.array(residual)
    for part in in_parts(*residual.shape[:2]):
        used = problem.windows.cells[part][..., None]
        by_state = np.where(used, shot.by_state[part] / problem.scale[:, None], 0.0)[..., ~problem.carried]
        tall = by_state.reshape(len(by_state), -1, by_state.shape[3])
        if not np.isfinite(tall).all():
            return residual
        size = np.linalg.norm(tall, axis=1, keepdims=True)
        basis, _ = np.linalg.qr(tall / np.where(size > 0, size, 1.0))
        basis = np.where(size > 0, basis, 0.0)
        flat = residual[part].reshape(len(tall), -1, 1)
        found[part] -= (basis @ (basis.swapaxes(1, 2) @ flat)).reshape(found[part].shape)
    return found


def _louder(problem: Problem, shot: Shot, residual: Array, asked: NDArray[np.intp]) -> Array:
    """p-values (n_y,) of no relation between the residual's power and the motion; nan if not ``asked``."""
    found = np.full(residual.shape[2], np.nan)
    if not len(asked):
        return found
    cells = problem.windows.cells
    motion = _motion(problem, shot)
    length = max(1, problem.windows.samples // STRETCHES)
    for k in asked:
        used = cells[..., k]
        pieces = [error[own, k] for error, own in zip(residual, used, strict=True)]
        coefficients, _ = autoregression(pieces)
        taps, first = np.append(1.0, -coefficients), len(coefficients)
        pairs = []
        for piece, moved, own in zip(pieces, motion, used, strict=True):
            power, moving = lfilter(taps, [1.0], piece)[first:] ** 2, moved[own][first:]
            count = len(power) // length or min(len(power), 1)
            parts = zip(
                np.array_split(power, max(count, 1)), np.array_split(moving, max(count, 1)), strict=True
            )
            pairs += [(a.mean(), b.mean()) for a, b in parts if len(a)]
        found[k] = _rank_test(np.array(pairs))
    return found


def _motion(problem: Problem, shot: Shot) -> Array:
    """How far inputs and states (w, H) are from their medians, each over its largest distance: their mean."""
    used = problem.windows.used
    signals = np.concatenate([problem.windows.inputs, shot.states], axis=2)
    away = np.abs(signals - np.median(signals[used], axis=0))
    most = away[used].max(axis=0)
    return (away[..., most > 0] / most[most > 0]).mean(axis=2) if (most > 0).any() else np.zeros(used.shape)


def _rank_test(pairs: Array) -> float:
    if len(pairs) < FEWEST or not np.ptp(pairs, axis=0).all():
        return 1.0
    return float(spearmanr(pairs[:, 0], pairs[:, 1], alternative="greater").pvalue)
