"""A CasADi function over arrays: one operation after another, each on all samples at once.

CasADi's interpreter takes a mapped function sample by sample, which costs more than the arithmetic. Here
numpy takes each operation over all samples. It pays where a function is asked for too few samples to compile
it. The numbers are the same to rounding.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import casadi as ca
import numpy as np
from numpy.typing import NDArray
from scipy.special import erf, erfinv

Array = NDArray[np.float64]
Operation = Callable[..., Any]


def _number(comparison: Operation) -> Operation:
    """1 where it holds, else 0."""
    return lambda *given: np.asarray(comparison(*given), dtype=float)


OPERATIONS: Mapping[int, Operation] = {
    ca.OP_ADD: np.add,
    ca.OP_SUB: np.subtract,
    ca.OP_MUL: np.multiply,
    ca.OP_DIV: np.divide,
    ca.OP_ASSIGN: lambda a: a,
    ca.OP_NEG: np.negative,
    ca.OP_SQ: np.square,
    ca.OP_TWICE: lambda a: a + a,
    ca.OP_INV: lambda a: 1.0 / a,
    ca.OP_LT: _number(np.less),
    ca.OP_LE: _number(np.less_equal),
    ca.OP_EQ: _number(np.equal),
    ca.OP_NE: _number(np.not_equal),
    ca.OP_NOT: _number(np.logical_not),
    ca.OP_AND: _number(np.logical_and),
    ca.OP_OR: _number(np.logical_or),
    ca.OP_IF_ELSE_ZERO: lambda chosen, a: np.where(chosen, a, 0.0),
    ca.OP_FABS: np.abs,
    ca.OP_SIGN: np.sign,
    ca.OP_COPYSIGN: np.copysign,
    ca.OP_FMIN: np.fmin,
    ca.OP_FMAX: np.fmax,
    ca.OP_EXP: np.exp,
    ca.OP_EXPM1: np.expm1,
    ca.OP_LOG: np.log,
    ca.OP_LOG1P: np.log1p,
    ca.OP_SQRT: np.sqrt,
    ca.OP_POW: np.power,
    ca.OP_CONSTPOW: np.power,
    ca.OP_SIN: np.sin,
    ca.OP_COS: np.cos,
    ca.OP_TAN: np.tan,
    ca.OP_ASIN: np.arcsin,
    ca.OP_ACOS: np.arccos,
    ca.OP_ATAN: np.arctan,
    ca.OP_ATAN2: np.arctan2,
    ca.OP_SINH: np.sinh,
    ca.OP_COSH: np.cosh,
    ca.OP_TANH: np.tanh,
    ca.OP_ASINH: np.arcsinh,
    ca.OP_ACOSH: np.arccosh,
    ca.OP_ATANH: np.arctanh,
    ca.OP_FLOOR: np.floor,
    ca.OP_CEIL: np.ceil,
    ca.OP_FMOD: np.fmod,
    ca.OP_REMAINDER: lambda a, b: a - b * np.rint(a / b),
    ca.OP_HYPOT: np.hypot,
    ca.OP_ERF: erf,
    ca.OP_ERFINV: erfinv,
}
"""What numpy has for the operations of CasADi."""


class Untaken(ValueError):
    """A function has an operation that is not in ``OPERATIONS``."""


def over_arrays(function: ca.Function) -> Callable[[Sequence[Sequence[Any]]], list[list[Any]]]:
    """``function`` of scalars, over arrays: from the entries of each of its arguments, numbers or arrays of
    one shape, the entries of each of its results, column after column.

    Raises:
        Untaken: if it has an operation that numpy has not.
    """
    steps = [_step(function, k) for k in range(function.n_instructions())]
    sizes, room = [function.nnz_out(k) for k in range(function.n_out())], function.sz_w()

    def run(given: Sequence[Sequence[Any]]) -> list[list[Any]]:
        work: list[Any] = [None] * room
        results: list[list[Any]] = [[None] * size for size in sizes]
        with np.errstate(all="ignore"):
            for code, operation, places, to in steps:
                if code == ca.OP_OUTPUT:
                    results[to[0]][to[1]] = work[places[0]]
                elif code == ca.OP_INPUT:
                    work[to[0]] = given[places[0]][places[1]]
                else:
                    work[to[0]] = operation(*(work[place] for place in places))
        return results

    return run


def _step(function: ca.Function, k: int) -> tuple[int, Operation, list[int], list[int]]:
    """Instruction ``k``: its code, what it does, from which places and to which."""
    code, places, to = (
        function.instruction_id(k),
        function.instruction_input(k),
        function.instruction_output(k),
    )
    if code == ca.OP_CONST:
        value = np.float64(function.instruction_constant(k))
        return code, lambda: value, [], to
    if code not in OPERATIONS and code not in (ca.OP_INPUT, ca.OP_OUTPUT):
        raise Untaken(f"operation {code} of CasADi is not in hybridid.simulation.over_arrays")
    return code, OPERATIONS.get(code, lambda a: a), places, to
