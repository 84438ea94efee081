"""The multiple-shooting transcription, the thesis' own: a node every so many samples.

Each horizon is cut into intervals. The state s_k in which one begins is a decision variable, and equality
constraints close the gaps (thesis Eq. 3-3):

    min over p, s of 1/2 sum |(y - y_hat(p, s)) / scale|^2    subject to    x(end of k - 1; s_(k-1), p) = s_k.

A horizon of one interval is N-step prediction, one horizon of one interval single shooting. Source: Bock,
Plitt (1984), IFAC Proceedings 17(2), 1603-1608.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from hybridid.estimators.problem import Problem
from hybridid.simulation.initial import measured_states
from hybridid.simulation.integrators import sample_step

Array = NDArray[np.float64]
EXPANDABLE = 60_000
"""Operations of an unrolled interval above which it stays a loop: unrolling is quicker to
run but its size grows with the interval."""


@dataclass(frozen=True)
class MultipleShooting:
    """Transcribes a problem into parameters and the state at the start of every ``interval`` samples."""

    interval: int

    def program(self, problem: Problem, p: Array, x0: Array) -> Program:
        """The problem as a nonlinear program, to be begun at ``p`` (n_p,), ``x0`` (w, n_x)."""
        return Program(problem, split(problem, self.interval, x0, p))


@dataclass(frozen=True)
class Intervals:
    """The shooting intervals of all horizons.

    Shapes: ``time`` (m, L), ``stages`` (m, L, n_U), ``inputs`` (m, L, n_u), ``outputs``
    (m, L, n_y), ``cells`` (m, L, n_y): which count. ``first`` marks the interval that opens a horizon,
    ``nodes`` (m, n_x) are start values of the states.
    """

    time: Array
    stages: Array
    inputs: Array
    outputs: Array
    cells: NDArray[np.bool_]
    first: NDArray[np.bool_]
    nodes: Array

    @property
    def count(self) -> int:
        """Number of intervals, m."""
        return len(self.first)


def split(problem: Problem, interval: int, x0: Array, p: Array) -> Intervals:
    """Cut each horizon of the problem into intervals of ``interval`` samples.

    A node starts from the smoothed record where an output shows the state, otherwise from a run of
    the horizon from its initial state ``x0`` (w, n_x) at ``p`` (n_p,), or from ``x0`` if that diverges.
    """
    windows = problem.windows
    length = min(interval, windows.length)
    states = [measured_states(problem.model, record) for record in problem.records]
    shown = np.array([s.observed_by is not None for s in problem.model.states])
    runs = problem.shooter(x0, p).states
    runs = np.where(np.isfinite(runs).all(axis=2, keepdims=True), runs, x0[:, None])
    rows: list[tuple[NDArray[Any], ...]] = []
    first: list[bool] = []
    for k, (record, start, stop) in enumerate(windows.origin):
        for begin in range(0, stop - start, length):
            index = np.minimum(np.arange(begin, begin + length), stop - start - 1)
            inside = (np.arange(begin, begin + length) < stop - start) & ~windows.holes[k, index]
            measured = windows.cells[k, index] | ~windows.used[k, index, None]
            node = x0[k] if begin == 0 else np.where(shown, states[record][start + begin], runs[k, begin])
            fields = (windows.time, windows.stages, windows.inputs, windows.outputs)
            rows.append((*(a[k, index] for a in fields), inside[:, None] & measured, node))
            first.append(begin == 0)
    time, stages, inputs, outputs, cells, nodes = (np.stack(column) for column in zip(*rows, strict=True))
    return Intervals(time, stages, inputs, outputs, cells, np.array(first), nodes)


@dataclass(frozen=True)
class Program:
    """The nonlinear program: variables are scaled free parameters (n,), then scaled nodes (m n_x,)."""

    problem: Problem
    intervals: Intervals

    @property
    def x_scale(self) -> Array:
        """Scale of each state, (n_x,), in its unit."""
        return np.array([s.scale for s in self.problem.model.states])

    @property
    def p_scale(self) -> Array:
        """Scale of each free parameter, (n,), in its unit."""
        return np.array([self.problem.model.parameters[k].scale for k in self.problem.positions])

    @property
    def gap_rows(self) -> list[int]:
        """Constraint rows: the states of each interval that continues the one before."""
        n_x = len(self.problem.model.states)
        return [int(k) * n_x + j for k in np.flatnonzero(~self.intervals.first) for j in range(n_x)]

    def bounds(self, p: Array) -> tuple[Array, Array, Array]:
        """Lower bounds, upper bounds and start of the scaled variables."""
        chosen = [self.problem.model.parameters[k] for k in self.problem.positions]
        states, nodes = self.problem.model.states, self.intervals.nodes / self.x_scale
        low, high = (
            np.tile([getattr(s, side) for s in states], (len(nodes), 1)) for side in ("lower", "upper")
        )
        low, high = low / self.x_scale, high / self.x_scale
        known = np.zeros(low.shape, dtype=bool)
        known[self.intervals.first] = ~self.problem.moving
        low[known] = high[known] = nodes[known]
        start = np.concatenate([p[self.problem.positions] / self.p_scale, nodes.ravel()])
        lower = np.concatenate([[q.lower for q in chosen] / self.p_scale, low.ravel()])
        upper = np.concatenate([[q.upper for q in chosen] / self.p_scale, high.ravel()])
        return lower, upper, np.clip(start, lower, upper)

    def unpack(self, variables: Array, p: Array) -> tuple[Array, Array]:
        """Parameters (n_p,) and nodes (m, n_x); IPOPT oversteps bounds by a rounding, they do not."""
        n = len(self.problem.positions)
        q = np.array(p)
        chosen = [self.problem.model.parameters[k] for k in self.problem.positions]
        q[self.problem.positions] = np.clip(
            variables[:n] * self.p_scale, [c.lower for c in chosen], [c.upper for c in chosen]
        )
        nodes = variables[n:].reshape(self.intervals.count, -1) * self.x_scale
        states = self.problem.model.states
        return q, np.clip(nodes, [s.lower for s in states], [s.upper for s in states])

    def nlp(self) -> tuple[dict[str, ca.MX], ca.Function]:
        """CasADi's ``{x, p, f, g}`` and the Gauss-Newton Hessian ``sigma J' J`` of f.

        ``p`` is the full parameter vector (n_p,); J is the Jacobian of the residuals.
        """
        problem, m = self.problem, self.intervals.count
        n, n_x = len(problem.positions), len(problem.model.states)
        variables = ca.MX.sym("w", n + m * n_x)
        given = ca.MX.sym("p", len(problem.model.parameters))
        scale = ca.repmat(ca.DM(self.x_scale), 1, m)
        nodes = ca.reshape(variables[n:], n_x, m) * scale
        ends, simulated = self._simulate(nodes, self._values(variables[:n], given))
        residual = self._residual(simulated)
        gap = (ends[:, : m - 1] - nodes[:, 1:]) / scale[:, 1:]
        # The gap before interval k is column k - 1 of the ends.
        rows = [row - n_x for row in self.gap_rows]
        constraints = ca.vec(gap)[rows] if rows else ca.MX(0, 1)
        nlp = {"x": variables, "p": given, "f": 0.5 * ca.sumsqr(residual), "g": constraints}
        jacobian = ca.jacobian(residual, variables)
        sigma, multipliers = ca.MX.sym("sigma"), ca.MX.sym("lam", len(rows))
        hessian = ca.triu(sigma * ca.mtimes(jacobian.T, jacobian))
        inputs, names = [variables, given, sigma, multipliers], ["x", "p", "lam_f", "lam_g"]
        return nlp, ca.Function("gauss_newton", inputs, [hessian], names, ["triu_hess_gamma_x_x"])

    def _values(self, scaled: ca.MX, given: ca.MX) -> ca.MX:
        values = ca.vertsplit(given)
        for k, position in enumerate(self.problem.positions):
            values[position] = scaled[k] * self.p_scale[k]
        return ca.vertcat(*values)

    def _residual(self, simulated: ca.MX) -> ca.MX:
        """``(y_hat - y) / s`` of the samples in use, as one column."""
        data = self.intervals
        n_y = data.outputs.shape[2]
        measured = data.outputs.reshape(-1, n_y).T
        weight = data.cells.reshape(-1, n_y).T / self.problem.scale[:, None]
        return ca.vec((simulated - ca.DM(measured)) * ca.DM(weight))

    def _simulate(self, nodes: ca.MX, values: ca.MX) -> tuple[ca.MX, ca.MX]:
        """States at the interval ends (n_x, m) and outputs (n_y, m L)."""
        data = self.intervals
        m, length = data.time.shape
        interval = _interval_function(self.problem, length).map(m)
        flat = [ca.DM(a.reshape(m * length, -1).T) for a in (data.time, data.stages, data.inputs)]
        ends, outputs = interval(nodes, *flat, ca.repmat(values, 1, m))
        return ends, outputs


def _interval_function(problem: Problem, length: int) -> ca.Function:
    """``(x, t, U, u, p) -> (x after the interval, outputs (n_y, length))``."""
    model, windows = problem.model, problem.windows
    step = sample_step(problem.shooter.integrator, model, windows.dt, windows.substeps, windows.held)
    x, t = ca.SX.sym("x", len(model.states)), ca.SX.sym("t")
    stages = ca.SX.sym("U", windows.stages.shape[2])
    u, p = ca.SX.sym("u", len(model.inputs)), ca.SX.sym("p", len(model.parameters))
    sample = ca.Function(
        "sample", [x, t, stages, u, p], [step(t, x, stages, p), model.h(t, x, u, p)], {"cse": True}
    )
    loop = sample.mapaccum("loop", length, 1)
    mx = [
        ca.MX.sym(name, f.shape[0], f.shape[1] * k)
        for name, f, k in zip("xtUup", (x, t, stages, u, p), (1, length, length, length, 1), strict=True)
    ]
    states, outputs = loop(*mx[:4], ca.repmat(mx[4], 1, length))
    function = ca.Function("interval", mx, [states[:, -1], outputs])
    return function.expand() if sample.n_instructions() * length <= EXPANDABLE else function
