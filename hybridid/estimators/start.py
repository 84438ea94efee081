"""Where a fit starts: a regression on smoothed derivatives, and which initial states.

With every state x seen through an output, ``x' = f(t, x, u, p)`` at the samples is a
least-squares problem in p alone, the equation error. Noise biases it; it is a start, not
an estimate. Source: Klein, Morelli (2006), Aircraft System Identification, ch. 5.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import lru_cache

import casadi as ca
import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares
from scipy.signal import savgol_filter

from hybridid.declarations import Parameter
from hybridid.estimators.problem import Problem
from hybridid.model import Model
from hybridid.records.record import Record
from hybridid.simulation.initial import (
    ORDER,
    measured_states,
    observed,
    output_derivative,
    telling,
    widest_half_width,
)
from hybridid.simulation.over_arrays import over_arrays
from hybridid.simulation.unobserved import free_run_states

Array = NDArray[np.float64]
MOST_SAMPLES = 5000
HALF_WIDTH = 25
"""Samples on each side that the smoothing polynomial of the derivatives uses."""
PRIOR = 0.3
"""Weight of the guess against some thousand samples: it only decides between parameters
that the samples cannot tell apart."""
SPREAD = 1.0
"""Further starts scatter by this standard deviation of the logarithm about the first."""


def regression_start(model: Model, records: Sequence[Record]) -> Array | None:
    """Parameter vector (n_p,) from the equation error, or None where states stay unseen.

    Effects with states of their own keep their guesses; all do where the equations at the
    guesses leave the range of numbers.
    """
    skeleton = _skeleton(model)
    if any(s.observed_by is None for s in skeleton.states) or not skeleton.free:
        return None
    p = _equation_error(skeleton, records)
    return model.values(dict(zip([q.name for q in skeleton.parameters], p, strict=True)))


def _skeleton(model: Model) -> Model:
    """``model`` without the effects that have states of their own."""
    kept = tuple(t for t in model.terms if not t.effect.states)
    if len(kept) == len(model.terms):
        return model
    skeleton = replace(model, terms=kept, adjustments={})
    return replace(skeleton, adjustments={p.name: _as_adjustment(p) for p in _shared(model, skeleton)})


def _shared(model: Model, skeleton: Model) -> list[Parameter]:
    names = {p.name for p in skeleton.parameters}
    return [p for p in model.parameters if p.name in names]


def _as_adjustment(parameter: Parameter) -> dict[str, float]:
    if parameter.fixed:
        return {"fixed": parameter.guess}
    return {"guess": parameter.guess, "lower": parameter.lower, "upper": parameter.upper}


def _equation_error(model: Model, records: Sequence[Record]) -> Array:
    t, x, rate, u = (
        np.concatenate(part) for part in zip(*(_sampled(model, r) for r in records), strict=True)
    )
    scale = rate.std(axis=0)
    scale[scale == 0] = 1.0
    periods = _periods(model)
    free = [k for k, q in enumerate(model.parameters) if not (q.fixed or q.name in periods)]
    chosen = [model.parameters[k] for k in free]
    size = np.array([q.scale for q in chosen])
    p = model.values()
    guess, prior = p[free] / size, PRIOR * np.eye(len(free))
    evaluated = _evaluated(model, (t, x, u, rate), scale, free)

    def full(z: Array) -> Array:
        q = np.array(p)
        q[free] = z * size
        return q

    def residual(z: Array) -> Array:
        return np.append(evaluated(full(z))[0], PRIOR * (z - guess))

    def jacobian(z: Array) -> Array:
        return np.vstack([evaluated(full(z))[1] * size, prior])

    if not np.isfinite(residual(guess)).all():
        return p
    fit = least_squares(
        residual,
        guess,
        jac=jacobian,
        bounds=([q.lower / q.scale for q in chosen], [q.upper / q.scale for q in chosen]),
        loss="soft_l1",
        f_scale=0.1,
    )
    return full(fit.x)


def _periods(model: Model) -> set[str]:
    """Names of the pitches and frequencies. The equation error has many minima over each, and begins to move
    it before the amplitudes are right; so it keeps the guess."""
    return {
        f"{term.name}.{p.name}"
        for term in model.terms
        for p in term.effect.parameters
        if p.sought in ("period", "frequency")
    }


def _sampled(model: Model, record: Record) -> tuple[Array, Array, Array, Array]:
    """Times, states, their rates and inputs at up to ``MOST_SAMPLES`` inner samples.

    All are smoothed alike, the inputs too: what smoothing takes from both sides of an equation
    does not unbalance it.
    """
    seen = {s.observed_by for s in model.states if s.observed_by is not None}
    width = min(HALF_WIDTH, (record.n - 1) // 4, *(widest_half_width(record.output(name)) for name in seen))
    states = measured_states(model, record, width)
    rates = np.stack(
        [
            output_derivative(record, s.observed_by, s.derivative + 1, width)
            for s in model.states
            if s.observed_by is not None
        ],
        axis=1,
    )
    step = max(1, record.n // MOST_SAMPLES)
    inner = np.arange(width, record.n - width, step)
    inner = inner[telling(record)[inner]] if record.partly else inner
    # a machine that swings freely has no input, which LAPACK refuses
    inputs = (
        savgol_filter(record.inputs, 2 * width + 1, ORDER, axis=0) if record.inputs.size else record.inputs
    )
    return record.time[inner], states[inner], rates[inner], inputs[inner]


def _evaluated(
    model: Model, data: tuple[Array, Array, Array, Array], scale: Array, free: list[int]
) -> Callable[[Array], tuple[Array, Array]]:
    """p (n_p,) to the equation error at the samples of ``data`` (times, states, inputs, rates), and its
    Jacobian by the parameters ``free``. A state's rate that depends on none is left out.

    It keeps the last result: the error is asked for first, then the Jacobian.
    """
    n_x, n_p = len(model.states), len(model.parameters)
    t, x, u = ca.SX.sym("t"), ca.SX.sym("x", n_x), ca.SX.sym("u", len(model.inputs))
    rate, p = ca.SX.sym("r", n_x), ca.SX.sym("p", n_p)
    error = (rate - model.f(t, x, u, p)) / ca.DM(scale)
    slope = ca.jacobian(error, p)[:, free]
    rows = sorted(set(slope.sparsity().row()))
    entries = [ca.densify(error[rows]), ca.densify(slope[rows, :])]
    run = over_arrays(ca.Function("error", [t, x, u, rate, p], entries, {"cse": True}))
    times, *columns = data
    given = [[times], *([np.ascontiguousarray(c) for c in part.T] for part in columns)]

    @lru_cache(maxsize=1)
    def at(values: bytes) -> tuple[Array, Array]:
        errors, slopes = run([*given, np.frombuffer(values).tolist()])
        found = np.empty((1 + len(free), len(rows), len(times)))
        for entry, one in zip(found.reshape(-1, len(times)), [*errors, *slopes], strict=True):
            entry[:] = one
        return found[0].ravel(), found[1:].reshape(len(free), -1).T

    return lambda q: at(q.tobytes())


def scattered(model: Model, p: Array, count: int, seed: int) -> list[Array]:
    """``count`` starts: ``p`` itself, the declared shape starts, then random ones inside the bounds."""
    rng = np.random.default_rng(seed)
    starts = [np.array(p)]
    for k, value in _shape_starts(model):
        starts.append(np.array(p))
        starts[-1][k] = value
    free = [k for k, q in enumerate(model.parameters) if not q.fixed]
    while len(starts) < count:
        start = np.array(p)
        for k in free:
            q = model.parameters[k]
            spread = rng.normal(0.0, SPREAD)
            moved = start[k] * np.exp(spread) if start[k] else q.scale * spread
            start[k] = np.clip(moved, q.lower, q.upper)
        starts.append(start)
    return starts[:count]


def _shape_starts(model: Model) -> list[tuple[int, float]]:
    """(place, value) of the further starts that effects declare for parameters that are free."""
    places = {q.name: (k, q) for k, q in enumerate(model.parameters) if not q.fixed}
    starts = []
    for term in model.terms:
        for q in term.effect.parameters:
            if f"{term.name}.{q.name}" in places:
                k, free = places[f"{term.name}.{q.name}"]
                values = q.starts_at(model.plant.port(term.port))
                starts += [(k, float(np.clip(value, free.lower, free.upper))) for value in values]
    return starts


def best_initial_states(
    problem: Problem, p: Array, candidates: Sequence[Array], clearly: float = 1.0
) -> Array:
    """For each horizon the candidate initial state (w, n_x) with the lowest cost at ``p``: the first one,
    unless another leaves less than the share ``clearly`` of its cost."""
    first, *others = candidates
    if all(np.array_equal(first, other) for other in others):
        return first
    costs = np.stack([_cost_by_horizon(problem, p, x0) for x0 in candidates])
    costs[0] *= clearly
    chosen = costs.argmin(axis=0)
    return np.stack([candidates[c][k] for k, c in enumerate(chosen)])


def x0_candidates(problem: Problem, p: Array) -> list[Array]:
    """Initial states (w, n_x) of the horizons to choose from: as the record shows them, at rest,
    and, where no output shows some of them, from a free run at ``p`` (n_p,)."""
    measured = problem.measured_x0()
    candidates = [measured, at_rest(problem, measured)]
    if not all(observed(problem.model)):
        runs = [free_run_states(problem.model, p, record) for record in problem.records]
        run = np.stack([runs[index][start] for index, start, _ in problem.windows.origin])
        candidates += [run, np.where(observed(problem.model), measured, run)]
    return candidates


def at_rest(problem: Problem, x0: Array) -> Array:
    """``x0`` with every state that is a derivative of an output at zero.

    A horizon that opens in sticking has hardly any gradient by its initial velocity, so
    a small error of the smoothed velocity can trap a fit.
    """
    resting = np.array(x0)
    for j, state in enumerate(problem.model.states):
        if state.derivative > 0:
            resting[:, j] = 0.0
    return resting


def _cost_by_horizon(problem: Problem, p: Array, x0: Array) -> Array:
    r = problem.residuals(problem.shooter(x0, p))
    with np.errstate(over="ignore", invalid="ignore"):
        cost = np.sum(r * r, axis=(1, 2))
    return np.where(np.isfinite(cost), cost, np.inf)
