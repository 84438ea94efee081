"""The sensitivities S = dx/d(x0, p) of a step and of the outputs, one column after another.

A function v of x and p maps a column s of S, that of an initial state or of a parameter, to

    v_x s + v_p                                              (v_p is zero for an initial state)

An explicit Runge-Kutta method, differentiated, is the same method on s, with the rates

    K_i = f_x(x_i) s_i + f_p(x_i)                            for the stages k_i = f(x_i)

So one function, ``forward``, computes the value with the derivatives, of a Runge-Kutta method those of one
stage. Another, ``column``, applies them to one column. There are as many columns as states and free
parameters. The code of both is four to ten times shorter than that of a whole step's derivative with all
columns, for as many operations.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import casadi as ca

from hybridid.model import Model
from hybridid.simulation.integrators import INTEGRATORS, RK4_TIMES, rk4
from hybridid.simulation.rosenbrock import Inputs
from hybridid.simulation.rosenbrock_column import differentiated


@dataclass(frozen=True)
class Derivatives:
    """Of one function: by the state, sparse (n, n_x), and by parameters, (n, n_free); (n, 1) for a column."""

    by_state: ca.SX
    by_parameter: ca.SX

    def along(self, s: ca.SX) -> ca.SX:
        """``v_x s + v_p``."""
        return self.by_state @ s + self.by_parameter


Along = Callable[[Sequence[Derivatives], ca.SX, ca.SX], ca.SX]
"""``(derivatives, s, h) -> column`` of the sensitivities of a value."""
OfColumn = Callable[[Sequence[tuple[ca.SX, ca.SX]], ca.SX, ca.SX], ca.SX]
"""``([(entries, v_p), ...], s, h) -> column``: of each stage its entries and, for this column, its v_p."""


@dataclass(frozen=True)
class Part:
    """A step or the outputs.

    ``forward`` (x, t, h, u, p) gives the value, or the rates of one of the ``stages`` of ``rk4``. With
    ``column`` it also gives the derivatives: the ``entries`` of v_x (of a step of ``rodas3``, the numbers of
    its ``Column``), then v_p by each free parameter, ``own_rows`` numbers each.
    ``column`` (s, d, v_p, h) gives one of the ``columns`` of the value's sensitivities; None without
    sensitivities. d are the derivatives of all stages, ``block`` numbers each. v_p is the part of d
    that begins at the column's own, or zero.
    """

    name: str
    forward: ca.Function
    column: ca.Function | None = None
    columns: int = 0
    entries: int = 0
    block: int = 0
    own_rows: int = 0
    stages: int = 1
    hop: int = 0
    """Inputs from the start of a step to its middle, and on to its end."""

    @property
    def rows(self) -> int:
        """Numbers of the value."""
        return int(self.forward.size1_out(0))

    @property
    def operations(self) -> int:
        """Of one call, with all columns."""
        each = 0 if self.column is None else self.column.n_instructions()
        return int(self.stages * self.forward.n_instructions() + self.columns * each)

    @property
    def functions(self) -> tuple[ca.Function, ...]:
        """The CasADi functions that it consists of."""
        return (self.forward,) if self.column is None else (self.forward, self.column)

    @property
    def said(self) -> str:
        """All that its C depends on."""
        return "".join([f"{self.stages} {self.hop} ", *(function.serialize() for function in self.functions)])


@dataclass(frozen=True)
class _At:
    """What a step or the outputs depend on; ``u`` are the inputs of a step, or of a sample."""

    model: Model
    t: ca.SX
    x: ca.SX
    u: ca.SX
    p: ca.SX
    h: ca.SX

    @classmethod
    def of(cls, model: Model, inputs: int) -> _At:
        sizes = (1, len(model.states), inputs, len(model.parameters), 1)
        return cls(model, *(ca.SX.sym(name, n) for name, n in zip("txuph", sizes, strict=True)))

    def derivatives(self, value: ca.SX, free: Sequence[str]) -> Derivatives:
        """Of ``value`` by x and by the parameters ``free``."""
        order = [parameter.name for parameter in self.model.parameters]
        return Derivatives(
            ca.jacobian(value, self.x), ca.jacobian(value, self.p)[:, [order.index(name) for name in free]]
        )

    def part(self, name: str, value: ca.SX, free: Sequence[str], along: Along, stages: int = 1) -> Part:
        """``value``, or the rates of each stage, with the derivatives, and what they make of a column."""
        made = self.derivatives(value, free)
        pattern = made.by_state.sparsity()

        def column(stage: Sequence[tuple[ca.SX, ca.SX]], s: ca.SX, h: ca.SX) -> ca.SX:
            return along([Derivatives(ca.SX(pattern, entries), own) for entries, own in stage], s, h)

        entries = ca.vertcat(*made.by_state.nonzeros())
        return self.made(name, value, entries, ca.densify(made.by_parameter), column, stages)

    def made(
        self, name: str, value: ca.SX, entries: ca.SX, own: ca.SX, column: OfColumn, stages: int = 1
    ) -> Part:
        """``value``, or the rates of each stage, with its ``entries`` (m,), its v_p, ``own`` (r, n_free), and
        what ``column`` makes of these."""
        held = ca.densify(ca.vertcat(entries, ca.vec(own)))
        block, m, rows = held.shape[0], entries.shape[0], own.shape[0]
        s, d = ca.SX.sym("s", self.x.shape[0]), ca.SX.sym("d", stages * block)
        b = ca.SX.sym("b", (stages - 1) * block + rows)
        begins = [k * block for k in range(stages)]
        after = ca.densify(column([(d[k : k + m], b[k : k + rows]) for k in begins], s, self.h))
        return Part(
            name,
            self._forward(f"{name}_forward", value, held),
            ca.Function(f"{name}_column", [s, d, b, self.h], [after], {"cse": True}),
            self.x.shape[0] + own.shape[1],
            m,
            block,
            rows,
            stages,
        )

    def alone(self, name: str, value: ca.SX, stages: int = 1) -> Part:
        """``value`` without sensitivities."""
        return Part(name, self._forward(f"{name}_forward", value), stages=stages)

    def _forward(self, name: str, *values: ca.SX) -> ca.Function:
        given = [self.x, self.t, self.h, self.u, self.p]
        return ca.Function(name, given, [ca.densify(v) for v in values], {"cse": True})


def step_part(
    name: str, model: Model, integrator: str, held: bool, free: Sequence[str] | None, wide: bool = False
) -> Part:
    """One step of ``integrator``; without sensitivities where ``free`` is None.

    ``wide``: several columns are computed side by side, so that long ones cost little. Then those of
    ``rodas3`` go through its stages (``rosenbrock_column``); else ``forward`` has the derivative of the whole
    step.
    """
    if integrator == "rk4":
        return _rk4_part(name, model, 0 if held else len(model.inputs), free)
    at = _At.of(model, len(model.inputs) * (1 if held else 3))
    if free is not None and wide:
        return _rodas3_part(name, at, held, free)
    value = INTEGRATORS[integrator](model, at.h, held)(at.t, at.x, at.u, at.p, at.h)
    return at.alone(name, value) if free is None else at.part(name, value, free, _as_a_whole)


def _rodas3_part(name: str, at: _At, held: bool, free: Sequence[str]) -> Part:
    """A step of ``rodas3``. Its entries are the numbers of a ``Column``; v_p are the q_i of its stages."""
    order = [parameter.name for parameter in at.model.parameters]
    inputs, chosen = Inputs.of(at.u, held), [order.index(one) for one in free]
    value, column, q = differentiated(at.model, at.t, at.h, at.x, inputs, at.p, chosen)

    def after(stage: Sequence[tuple[ca.SX, ca.SX]], s: ca.SX, h: ca.SX) -> ca.SX:
        ((numbers, own),) = stage
        return column.with_numbers(numbers).along(s, own, h)

    return at.made(name, value, column.numbers, q, after)


def _rk4_part(name: str, model: Model, hop: int, free: Sequence[str] | None) -> Part:
    """A step of ``rk4``, of which ``forward`` is one stage."""
    at, stages = _At.of(model, len(model.inputs)), len(RK4_TIMES)
    rates = model.f(at.t, at.x, at.u, at.p)
    if free is None:
        return replace(at.alone(name, rates, stages), hop=hop)
    return replace(
        at.part(name, rates, free, lambda of, s, h: rk4(lambda i, y: of[i].along(y), s, h), stages),
        hop=hop,
    )


def output_part(name: str, model: Model, free: Sequence[str] | None) -> Part:
    """The outputs of a sample; without sensitivities where ``free`` is None."""
    at = _At.of(model, len(model.inputs))
    value = model.h(at.t, at.x, at.u, at.p)
    return at.alone(name, value) if free is None else at.part(name, value, free, _as_a_whole)


def _as_a_whole(of: Sequence[Derivatives], s: ca.SX, h: ca.SX) -> ca.SX:
    return of[0].along(s)


def total_derivative(model: Model, value: ca.SX, x: ca.SX, p: ca.SX, s: ca.SX, free: Sequence[str]) -> ca.SX:
    """``d value / d(x0, p) = value_x S + [0, value_p]`` with ``S = dx / d(x0, p)``, of the ``free`` p."""
    n_x, order = x.shape[0], [parameter.name for parameter in model.parameters]
    through = ca.jacobian(value, x) @ s
    if free:
        direct = ca.jacobian(value, p)[:, [order.index(name) for name in free]]
        through = ca.horzcat(through[:, :n_x], through[:, n_x:] + direct)
    return through
