"""NARX networks: training beside torch, and a free run beside its bare matrix products; simulated errors."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace

import numba
import numpy as np
from numpy.typing import NDArray

from benchmarks.speed.contest import Way, contest
from benchmarks.speed.machine import cycles_a_second
from benchmarks.speed.network_rivals import (
    SYSIDENTPY,
    by_sysidentpy,
    by_torch,
    run_by_sysidentpy,
    run_by_torch,
)
from benchmarks.speed.row import OURS, Row, rows_of
from benchmarks.speed.simulations import AT_ONCE
from hybridid.residuals.narx import Weights, scaled_run
from hybridid.residuals.objective import FreeRun, Shape
from hybridid.residuals.orders import Orders
from hybridid.residuals.recursion import _add, _remember
from hybridid.residuals.regressors import Scaling
from hybridid.residuals.samples import Samples, samples_of
from hybridid.residuals.second_order import Descent
from hybridid.residuals.series import ErrorSeries, Surroundings
from hybridid.residuals.settings import Architecture, Training
from hybridid.residuals.stretches import training
from hybridid.simulation.compiler import widest

Array = NDArray[np.float64]
Say = Callable[[str], None]
TRAINING = "NARX training on a whole record"
FREE_RUN = "NARX free run beside its bare products"
SIZES = ((3, 8), (3, 16), (3, 32), (5, 32), (4, 64))
"""Hidden layers and neurons in each: of the thesis' Table 4.4, and the widest that counts as small."""
STEPS = 200
"""Of our training."""
PEER = "SysIdentPy, its Adam, one step ahead"
OF_ELU = 38
"""Operations of one ELU."""
DECAY = 0.1
LONG = 20_000
"""Samples of a free run: what a call costs beside them does not count."""


def networks(repeats: int, say: Say, quick: bool) -> Iterator[Row]:
    """Training of 3 x 16 on 600 samples from the same start, then free runs of every size."""
    samples, one = _samples(150 if quick else 600), _architecture(3, 16)
    shape = Shape.of(one, 1.0)

    def judged(weights: Weights) -> float:
        return _judged(weights, samples, shape.lags)

    say(f"{TRAINING}: 3 x 16, {len(samples.error)} samples")
    ways = [
        Way(OURS, lambda: _ours(samples, one)),
        Way("plain torch loop, torch's L-BFGS", lambda: by_torch(samples, shape, DECAY, True), slow=True),
        Way("plain torch loop, torch's Adam", lambda: by_torch(samples, shape, DECAY, False), slow=True),
    ]
    if SYSIDENTPY:
        start = shape.weights(shape.start(np.random.default_rng(0)))
        ways.append(Way(PEER, lambda: by_sysidentpy(samples, start, judged), slow=True))
    found = contest(ways, repeats, say)
    what = f"3 x 16, {len(samples.error)} samples"
    yield from rows_of(
        TRAINING, what, found, "simulated", lambda told: "objective {:.4f}, {} steps".format(*told)
    )
    for depth, width in SIZES[:2] if quick else SIZES:
        yield from _free_run(depth, width, repeats, say)


def _architecture(depth: int, width: int) -> Architecture:
    return Architecture(Orders(7, (2, 2), 4), depth, width)


def _samples(n: int) -> Samples:
    """Errors of ``e(t) = 1.6 e(t-1) - 0.7 e(t-2) + 0.1 tanh(u1) + 0.05 u2 y``, scaled."""
    rng = np.random.default_rng(0)
    smooth = np.full(20, 20**-0.5)
    u = np.stack([np.convolve(rng.normal(size=n + 19), smooth, "valid") for _ in range(2)], axis=1)
    gray, error = np.convolve(u[:, 0], smooth, "same"), np.zeros(n)
    for t in range(2, n):
        driven = 0.1 * np.tanh(u[t - 1, 0]) + 0.05 * u[t - 1, 1] * gray[t - 1]
        error[t] = 1.6 * error[t - 1] - 0.7 * error[t - 2] + driven
    seen = Surroundings("y", "m", 0.01, u, ("u1", "u2"), gray, (0,))
    series = (ErrorSeries("record", "simulated", error, seen),)
    settings = Training(blocks=30, precision="double")
    return samples_of(
        series, Scaling.of(series, 1), _architecture(3, 16), _architecture(3, 16).orders, settings
    )


def _ours(samples: Samples, one: Architecture) -> tuple[float, int]:
    settings = Training((None,), optimiser="lbfgs", epochs=STEPS, patience=STEPS, weight_decay=DECAY)
    found = Descent(one, samples, settings, 1.0, 100.0).run(0, lambda *told: None)
    return _judged(found.members[0], samples, one.orders.error), STEPS


def _judged(weights: Weights, samples: Samples, lags: int) -> float:
    """Our objective: mean square error of a free run on the training blocks, and the size of the weights."""
    squares = sum(float((a**2).sum()) for a in (*weights.matrices, *weights.biases))
    counts = training(samples, lags, None).counts > 0
    error, rows = samples.doubles
    run, _ = scaled_run([weights], rows, np.zeros(lags), 0.0, 100.0)
    return float(np.mean((run - error)[counts] ** 2)) + 0.5 * DECAY * squares


def _free_run(depth: int, width: int, repeats: int, say: Say) -> Iterator[Row]:
    one, samples = _architecture(depth, width), _samples(LONG)
    shape = Shape.of(one, 1.0)
    flat = shape.start(np.random.default_rng(0))
    error, rows = samples.doubles
    weights = shape.weights(flat)
    what = f"{depth} x {width}, {len(error)} samples"
    say(what)
    slowest = FreeRun(shape, samples, training(samples, shape.lags, None), 1e6)

    def with_gradient() -> str:
        square, _ = slowest.with_gradient(flat)
        return f"mean square error {square:.6f}"

    def products(function: Callable[..., float]) -> str:
        _bare(function, weights, rows, shape.lags)
        return "products alone"

    ways = [
        Way(OURS, lambda: _rms(scaled_run([weights], rows, np.zeros(shape.lags), 0.0, 1e6)[0])),
        Way("its bare products, each sample from the last ones", lambda: products(_fed_back)),
        Way("bare products in a plain loop, each sample alone", lambda: products(_alone)),
        Way("hybridid, with its gradient", with_gradient),
    ]
    if (depth, width) == SIZES[1]:
        ways.append(Way("plain torch loop", lambda: _rms(run_by_torch(shape, flat, rows)), slow=True))
        if SYSIDENTPY:
            ways.append(Way("SysIdentPy", lambda: _rms(run_by_sysidentpy(samples, weights)), slow=True))
    operations = (2 * weights.count + OF_ELU * depth * width) * len(error)
    least = operations / widest() / AT_ONCE / cycles_a_second()
    for row in rows_of(FREE_RUN, what, contest(ways, max(repeats, 20), say), "simulated"):
        yield replace(row, least=least) if row.way == OURS else row


def _rms(run: Array) -> str:
    return f"RMS {np.sqrt(np.mean(run**2)):.6f}"


def _bare(function: Callable[..., float], weights: Weights, rows: Array, lags: int) -> float:
    first, *inner, last = weights.matrices
    driven, by_past = rows @ first[:, lags:].T, np.ascontiguousarray(first[:, :lags].T)
    hidden = np.array([matrix.T for matrix in inner]).reshape(-1, len(first), len(first))
    return float(function(driven, by_past, hidden, np.ascontiguousarray(last[0]), np.zeros(lags)))


@numba.njit(cache=False)
def _fed_back(driven: Array, by_past: Array, hidden: Array, output: Array, past: Array) -> float:
    """The products of our free run in the same code and order, without ELU and biases: a linear network."""
    samples, width = driven.shape
    sums, given, total = np.empty(width), np.empty(width), 0.0
    for t in range(samples):
        for i in range(width):
            sums[i] = driven[t, i]
        _add(sums, by_past, past)
        for layer in range(hidden.shape[0]):
            for i in range(width):
                given[i] = sums[i]
                sums[i] = 0.0
            _add(sums, hidden[layer], given)
        value = 0.0
        for i in range(width):
            value += output[i] * sums[i]
        _remember(past, value)
        total += value
    return total


@numba.njit(cache=False)
def _alone(driven: Array, by_past: Array, hidden: Array, output: Array, past: Array) -> float:
    """Every product of weights and signals in a plain loop; no sample waits for another."""
    samples, width = driven.shape
    sums, given, total = np.empty(width), np.empty(width), 0.0
    for t in range(samples):
        for i in range(width):
            sums[i] = driven[t, i]
        for k in range(past.shape[0]):
            for i in range(width):
                sums[i] += by_past[k, i] * past[k]
        for layer in range(hidden.shape[0]):
            for i in range(width):
                given[i] = sums[i]
                sums[i] = 0.0
            for k in range(width):
                for i in range(width):
                    sums[i] += hidden[layer, k, i] * given[k]
        for i in range(width):
            total += output[i] * sums[i]
    return total
