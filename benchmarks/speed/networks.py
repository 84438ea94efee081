"""NARX networks: training beside torch, and a free run beside its bare matrix products; simulated errors."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import numba
import numpy as np
import torch
from numpy.typing import NDArray

from benchmarks.speed.contest import Way, contest
from benchmarks.speed.row import OURS, Row, rows_of
from hybridid.residuals.narx import Weights, scaled_run
from hybridid.residuals.objective import FreeRun, Shape
from hybridid.residuals.orders import Orders
from hybridid.residuals.regressors import Scaling
from hybridid.residuals.samples import Samples, samples_of
from hybridid.residuals.second_order import Descent
from hybridid.residuals.series import ErrorSeries, Surroundings
from hybridid.residuals.settings import Architecture, Training
from hybridid.residuals.stretches import training

Array = NDArray[np.float64]
Say = Callable[[str], None]
TRAINING = "NARX training on a whole record"
FREE_RUN = "NARX free run beside its bare products"
SIZES = ((3, 8), (3, 16), (3, 32), (5, 32), (4, 64))
"""Hidden layers and neurons in each: of the thesis' Table 4.4, and the widest that counts as small."""
STEPS, THEIRS = 200, 50
"""Of our training, and of torch's, which takes minutes: hence the rows say what objective each reached."""
DECAY = 0.1
LONG = 20_000
"""Samples of a free run: what a call costs beside them does not count."""


def networks(repeats: int, say: Say, quick: bool) -> Iterator[Row]:
    """Training of 3 x 16 on 600 samples from the same start, then free runs of every size."""
    samples, one = _samples(150 if quick else 600), _architecture(3, 16)
    say(f"{TRAINING}: 3 x 16, {len(samples.error)} samples")
    ways = [
        Way(OURS, lambda: _ours(samples, one)),
        Way("plain torch loop, torch's L-BFGS", lambda: _torch(samples, one, lbfgs=True), slow=True),
        Way("plain torch loop, torch's Adam", lambda: _torch(samples, one, lbfgs=False), slow=True),
    ]
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
    (weights,) = found.members
    squares = sum(float((a**2).sum()) for a in (*weights.matrices, *weights.biases))
    counts = training(samples, one.orders.error, None).counts > 0
    error, rows = samples.doubles
    run, _ = scaled_run([weights], rows, np.zeros(one.orders.error), 0.0, 100.0)
    return float(np.mean((run - error)[counts] ** 2)) + 0.5 * DECAY * squares, STEPS


def _torch(samples: Samples, one: Architecture, lbfgs: bool) -> tuple[float, int]:
    """The same objective from the same start, sample by sample in torch, differentiated by autograd."""
    torch.set_num_threads(1)
    shape = Shape.of(one, 1.0)
    tensors = [
        torch.tensor(p, requires_grad=True) for p in shape.parts(shape.start(np.random.default_rng([0, 0])))
    ]
    error, rows = (torch.from_numpy(a) for a in samples.doubles)
    counts = torch.from_numpy(training(samples, shape.lags, None).counts) > 0

    def objective() -> torch.Tensor:
        by_past, by_rows, bias, hidden, biases, output, offset = tensors
        driven, past, found = rows @ by_rows + bias, torch.zeros(shape.lags, dtype=torch.float64), []
        for drive in driven:
            x = torch.nn.functional.elu(drive + past @ by_past)
            for matrix, shift in zip(hidden, biases, strict=True):
                x = torch.nn.functional.elu(shift + x @ matrix)
            found.append(offset + x @ output)
            past = torch.cat([found[-1], past[:-1]])
        left = (torch.cat(found) - error)[counts].square().mean()
        return left + 0.5 * DECAY * sum((t.square().sum() for t in tensors), torch.tensor(0.0))

    options: Any = {"lr": 1.0, "max_iter": THEIRS, "history_size": 20, "line_search_fn": "strong_wolfe"}
    descent = torch.optim.LBFGS(tensors, **options) if lbfgs else torch.optim.Adam(tensors, lr=3e-3)

    def closure() -> torch.Tensor:
        descent.zero_grad()
        value = objective()
        value.backward()  # type: ignore[no-untyped-call]
        return value

    for _ in range(1 if lbfgs else THEIRS):
        descent.step(closure)  # type: ignore[arg-type]
    return float(objective().detach()), THEIRS


def _free_run(depth: int, width: int, repeats: int, say: Say) -> Iterator[Row]:
    one, samples = _architecture(depth, width), _samples(LONG)
    shape = Shape.of(one, 1.0)
    flat = shape.start(np.random.default_rng(0))
    error, rows = samples.doubles
    weights = shape.weights(flat)
    what = f"{depth} x {width}, {len(error)} samples"
    say(what)

    def ours() -> str:
        run, _ = scaled_run([weights], rows, np.zeros(shape.lags), 0.0, 1e6)
        return f"RMS {np.sqrt(np.mean(run**2)):.6f}"

    def bare() -> str:
        _bare(weights, rows, shape.lags)
        return "products alone"

    slowest = FreeRun(shape, samples, training(samples, shape.lags, None), 1e6)

    def with_gradient() -> str:
        square, _ = slowest.with_gradient(flat)
        return f"mean square error {square:.6f}"

    ways = [Way(OURS, ours), Way("bare products", bare), Way("hybridid, with its gradient", with_gradient)]
    yield from rows_of(FREE_RUN, what, contest(ways, max(repeats, 20), say), "simulated")


def _bare(weights: Weights, rows: Array, lags: int) -> float:
    first, *inner, last = weights.matrices
    driven, by_past = rows @ first[:, lags:].T, np.ascontiguousarray(first[:, :lags].T)
    hidden = np.array([matrix.T for matrix in inner]).reshape(-1, len(first), len(first))
    return float(_products(driven, by_past, hidden, np.ascontiguousarray(last[0]), np.zeros(lags)))


@numba.njit(cache=False)
def _products(driven: Array, by_past: Array, hidden: Array, output: Array, past: Array) -> float:
    """Every product of weights and signals, sample by sample, and nothing else."""
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
