"""``Shooter``: simulates many horizons at once, with or without sensitivities.

The sensitivities follow the variational equation of the discrete map
``x+ = step(x, p)``: ``S+ = step_x S + [0, step_p]`` with ``S = dx/d(x0, p)``, exact for
the integrator in use. Source: Bock (1987), Randwertproblemmethoden zur
Parameteridentifizierung, "internal numerical differentiation".
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import cached_property

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from hybridid.model import Model
from hybridid.simulation.buffers import call
from hybridid.simulation.integrators import sample_step
from hybridid.simulation.machine_code import Code, lanes_for
from hybridid.simulation.sensitivities import total_derivative
from hybridid.simulation.windows import Windows

Array = NDArray[np.float64]
IN_TURN = 10
"""Ratio of the times that CasADi's interpreter needs for horizons in sequence and for all at once."""


@dataclass(frozen=True)
class Shot:
    """Simulated horizons.

    Shapes: ``outputs`` (w, H, n_y), ``states`` (w, H, n_x), ``final`` (w, n_x) the state one
    sample after the last. With sensitivities (else empty): ``by_state`` (w, H, n_y, n_x) = dy/dx0 and
    ``by_parameter`` (w, H, n_y, n_free) = dy/dp. With carried states: ``ends_by`` (w, n_x + n_free, n_x),
    the derivatives by x0 and p of the state after each horizon's last sample.

    Or, in place of outputs and states, the products over each horizon of r, what the weighted outputs leave
    of the record, and of their sensitivities J: ``spent`` r'r (w,), not a number where the horizon diverges,
    ``square`` J'J (w, n_x + n_free, n_x + n_free), and ``error`` J'r (w, n_x + n_free).
    """

    outputs: Array = field(default_factory=lambda: np.empty(0))
    states: Array = field(default_factory=lambda: np.empty(0))
    final: Array = field(default_factory=lambda: np.empty(0))
    by_state: Array = field(default_factory=lambda: np.empty(0))
    by_parameter: Array = field(default_factory=lambda: np.empty(0))
    ends_by: Array = field(default_factory=lambda: np.empty(0))
    spent: Array = field(default_factory=lambda: np.empty(0))
    square: Array = field(default_factory=lambda: np.empty(0))
    error: Array = field(default_factory=lambda: np.empty(0))

    def ends(self, windows: Windows) -> Array:
        """State of each horizon one sample after its last in use, (w, n_x)."""
        after = np.concatenate([self.states, self.final[:, None]], axis=1)
        return after[np.arange(windows.count), list(windows.lengths)]

    @property
    def finite(self) -> bool:
        """Whether all outputs are finite."""
        return bool(np.isfinite(self.outputs).all())

    @property
    def sensitive(self) -> bool:
        """Whether there are sensitivities, or their products."""
        return self.by_state.ndim > 1 or self.multiplied

    @property
    def compared(self) -> bool:
        """Whether there is what each horizon spent, in place of its outputs."""
        return len(self.spent) > 0

    @property
    def multiplied(self) -> bool:
        """Whether there are products of the sensitivities in their place."""
        return self.square.ndim > 1


@dataclass(frozen=True)
class Shooter:
    """Simulates ``windows`` with ``model``; ``free`` lists the parameters to differentiate by.

    ``carried`` are the indices of states whose initial values continue from the end of the preceding horizon,
    if that horizon is among ``windows``; their entries of ``x0`` are then ignored. The sensitivities of a
    horizon are derivatives by its own initial state.

    It runs machine code if compiling it pays, else CasADi's interpreter.
    """

    model: Model
    windows: Windows
    free: tuple[str, ...] = ()
    integrator: str = "rk4"
    carried: tuple[int, ...] = ()

    def __call__(self, x0: Array, p: Array, sensitivities: bool = False) -> Shot:
        """Simulate every horizon from ``x0`` (w, n_x) at the parameters ``p`` (n_p,)."""
        if self.code.worth_it:
            given = (self.windows, self.carried, x0, p, sensitivities)
            states, outputs, final, *slopes = self.code(*given)
            return _shot(states, outputs, final, *(slopes if sensitivities else ()))
        return self._interpreted(x0, p, sensitivities)

    def compared(
        self, x0: Array, p: Array, weights: Array, sensitivities: bool, limit: float = np.inf
    ) -> Shot:
        """The same with products in place of outputs and sensitivities where machine code runs; ``weights``
        (w, H, n_y) of the outputs, 0 where one does not count. The products take less memory, and less time
        than to write the sensitivities down. Once r'r of all horizons is above ``limit``, it is infinite and
        the rest is not simulated."""
        if not self.code.worth_it:
            return self(x0, p, sensitivities)
        given = (self.windows, self.carried, x0, p, sensitivities, weights, limit)
        spent, *products, ends_by = self.code.compared(*given)
        if not sensitivities:
            return Shot(spent=spent)
        return Shot(ends_by=ends_by, spent=spent, square=products[0], error=products[1])

    def over(self, windows: Windows, times: int = 1) -> Shooter:
        """The same shooter over other horizons; it shares the compiled code. It is to simulate ``times`` as
        often as a fit does: compiling may pay then, where it did not for the fit."""
        other = replace(self, windows=windows)
        code = self.code
        other.__dict__["code"] = code if code.worth_it else replace(code, steps=times * code.steps)
        return other

    @cached_property
    def code(self) -> Code:
        """One step, as machine code."""
        w = self.windows
        steps = w.count * w.length * w.substeps * (IN_TURN if self._hands_on else 1)
        return Code(self.model, self.free, self.integrator, w.held, steps, self._lanes)

    @property
    def _lanes(self) -> int:
        """Horizons to run side by side: of those that hand inner states on, one of each record."""
        return lanes_for(self.windows.follows.count(-1) if self.carried else self.windows.count)

    @property
    def _hands_on(self) -> bool:
        return bool(self.carried) and max(self.windows.follows) >= 0

    def _interpreted(self, x0: Array, p: Array, sensitivities: bool) -> Shot:
        n_x = len(self.model.states)
        eye = np.tile(np.eye(n_x + len(self.free), n_x), (self.windows.count, 1, 1))
        start = (np.array(x0), eye) if sensitivities else (np.array(x0),)
        if self._hands_on:
            states, outputs, *slopes, final, ends_by = self._in_turn(start, p)
            return _shot(states, outputs, final, *slopes, *((ends_by,) if sensitivities else ()))
        (states, outputs, *slopes, final), _ = self._run(start, p)
        return _shot(states, outputs, final, *slopes)

    def _in_turn(self, start: tuple[Array, ...], p: Array) -> list[Array]:
        """As ``_run``, horizon after horizon, each handing its inner states on; and what the last of
        ``start`` has become at the end of each."""
        found: list[list[Array]] = []
        kept: list[Array] = []
        for k, before in enumerate(self.windows.follows):
            lone = replace(self, windows=self.windows.select([k]))
            begin = tuple(a[k : k + 1].copy() for a in start)
            if before >= 0 and np.isfinite(kept[before]).all():
                begin[0][:, list(self.carried)] = kept[before][:, list(self.carried)]
            results, ends = lone._run(begin, p)
            found.append([*results, ends[-1]])
            kept.append(ends[0])
        return [np.concatenate(parts) for parts in zip(*found, strict=True)]

    def _run(self, start: tuple[Array, ...], p: Array) -> tuple[list[Array], tuple[Array, ...]]:
        """From ``start``, states (w, n_x) and maybe their sensitivities (w, n_s, n_x): the states, outputs
        and outputs' sensitivities of every sample with the state one sample after the last, and, of the first
        horizon, what ``start`` has become at its end."""
        w, length, count = self.windows.count, self.windows.length, self.windows.chunk
        n_x, n_y = len(self.model.states), len(self.model.outputs)
        n_s = n_x + len(self.free)
        compiled = self._sensitivity_chunk if len(start) > 1 else self._chunk
        held_p = np.tile(p, (w * count, 1))
        # CasADi stacks columns: its (rows, w count columns) is a C-ordered (w, count, columns, rows).
        next_shapes = [(w, count, n_x), (w, count, n_s, n_x)][: len(start)]
        shapes = [*next_shapes, (w, count, n_x), (w, count, n_y), (w, count, n_s, n_y)][
            : 3 + 2 * (len(start) - 1)
        ]
        results = [np.empty((*shape[:1], length, *shape[2:])) for shape in shapes[len(start) :]]
        ends, last = start, self.windows.lengths[0] - 1
        for begin in range(0, length, count):
            part = slice(begin, begin + count)
            given = [*start, *(a[:, part] for a in self._data), held_p]
            values = call(compiled, given, shapes)
            start = tuple(value[:, -1] for value in values[: len(start)])
            if begin <= last < begin + count:
                ends = tuple(value[:1, last - begin] for value in values[: len(start)])
            for result, value in zip(results, values[len(start) :], strict=True):
                result[:, part] = value
        return [*results, start[0]], ends

    @property
    def _data(self) -> tuple[Array, Array, Array]:
        return self.windows.time[..., None], self.windows.stages, self.windows.inputs

    @cached_property
    def _chunk(self) -> ca.Function:
        return self._of_chunk("chunk", 1, self._sample, ())

    @cached_property
    def _sensitivity_chunk(self) -> ca.Function:
        return self._of_chunk("sensitivity chunk", 2, self._sample_with_sensitivities, self.free)

    def _of_chunk(
        self, name: str, handed_on: int, sample: Callable[[], ca.Function], by: tuple[str, ...]
    ) -> ca.Function:
        """``sample`` over a chunk of each horizon; its first ``handed_on`` results go to the next sample.
        What is not of the number of horizons is made once a model."""
        w = self.windows
        key = (name, by, self.integrator, w.held, w.dt, w.substeps, w.chunk)
        one = self.model.kept(key, lambda: sample().mapaccum("chunk", w.chunk, handed_on))
        return one.map(w.count)

    def _sample(self) -> ca.Function:
        t, stages, u, p = self._symbols()
        x = ca.SX.sym("x", len(self.model.states))
        out = [self._step(t, x, stages, p), x, self.model.h(t, x, u, p)]
        return ca.Function("sample", [x, t, stages, u, p], [ca.densify(v) for v in out], {"cse": True})

    def _sample_with_sensitivities(self) -> ca.Function:
        t, stages, u, p = self._symbols()
        n_x = len(self.model.states)
        x, s = ca.SX.sym("x", n_x), ca.SX.sym("S", n_x, n_x + len(self.free))
        x_next, y = self._step(t, x, stages, p), self.model.h(t, x, u, p)
        s_next, dy = (total_derivative(self.model, value, x, p, s, self.free) for value in (x_next, y))
        out = [ca.densify(v) for v in (x_next, s_next, x, y, dy)]
        return ca.Function("sample", [x, s, t, stages, u, p], out, {"cse": True})

    @property
    def _step(self) -> ca.Function:
        w = self.windows
        key = ("sample step", self.integrator, w.held, w.dt, w.substeps)
        return self.model.kept(
            key, lambda: sample_step(self.integrator, self.model, w.dt, w.substeps, w.held)
        )

    def _symbols(self) -> tuple[ca.SX, ...]:
        n_u = len(self.model.inputs)
        stages = self.windows.stages.shape[2]
        sizes = (1, stages, n_u, len(self.model.parameters))
        return tuple(ca.SX.sym(name, n) for name, n in zip("tUup", sizes, strict=True))


def _shot(states: Array, outputs: Array, final: Array, *slopes: Array) -> Shot:
    """``slopes``: of the outputs (w, H, n_x + n_free, n_y), as CasADi's columns lie, and of the ends."""
    if not slopes:
        return Shot(outputs, states, final)
    by, n_x = slopes[0].swapaxes(2, 3), states.shape[2]
    return Shot(outputs, states, final, by[..., :n_x], by[..., n_x:], *slopes[1:])
