"""A CasADi function over arrays gives what CasADi gives sample by sample."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest

from hybridid.simulation.over_arrays import Untaken, over_arrays

X, Y = ca.SX.sym("x"), ca.SX.sym("y")
ONE = [
    ca.sqrt, ca.exp, ca.expm1, ca.log, ca.log1p, ca.sin, ca.cos, ca.tan, ca.asin, ca.acos, ca.atan, ca.sinh,
    ca.cosh, ca.tanh, ca.asinh, ca.atanh, ca.floor, ca.ceil, ca.erf, ca.fabs, ca.sign, lambda x: x * x,
    ca.logic_not, lambda x: -x, lambda x: 1 / x, lambda x: 2 * x, lambda x: x**2.5, lambda x: ca.acosh(1 + x),
]  # fmt: skip
TWO = [
    ca.fmin, ca.fmax, ca.atan2, ca.hypot, ca.copysign, ca.fmod, ca.remainder, ca.logic_and, ca.logic_or,
    lambda x, y: x + y, lambda x, y: x - y, lambda x, y: x * y, lambda x, y: x / y, lambda x, y: x**y,
    lambda x, y: x < y, lambda x, y: x <= y, lambda x, y: x == y, lambda x, y: x != y,
    lambda x, y: (x < y) + (x > y), lambda x, y: ca.if_else(x < y, 3.0, y),
]  # fmt: skip


@pytest.mark.parametrize("value", [*(f(X) for f in ONE), *(f(X, Y) for f in TWO)], ids=str)
def test_every_operation_is_casadis_own(value):
    function = ca.Function("one", [X, Y], [value])
    x, y = np.array([0.1, 0.5, 0.9, 0.3]), np.array([0.4, 0.5, 0.2, 0.7])
    (((found,)),) = over_arrays(function)([[x], [y]])
    each = np.array([float(function(a, b)) for a, b in zip(x, y, strict=True)])
    np.testing.assert_allclose(np.asarray(found, dtype=float), each, rtol=1e-14, atol=1e-16)


def test_the_inverse_error_function_is_casadis_approximation_of_it():
    function = ca.Function("one", [X], [ca.erfinv(X)])
    (((found,)),) = over_arrays(function)([[np.array([0.5])]])
    assert found[0] == pytest.approx(float(function(0.5)), rel=1e-9)


def test_entries_of_matrices_come_column_after_column():
    v = ca.SX.sym("v", 2)
    function = ca.Function("two", [v, X], [ca.densify(ca.horzcat(v * X, v + 1)), ca.SX(4)])
    matrix, (constant,) = over_arrays(function)([[np.array([1.0, 2.0]), 5.0], [10.0]])
    assert [np.asarray(one).tolist() for one in matrix] == [[10.0, 20.0], 50.0, [2.0, 3.0], 6.0]
    assert constant == 4.0


def test_an_operation_that_numpy_has_not_is_refused(monkeypatch):
    monkeypatch.delitem(over_arrays.__globals__["OPERATIONS"], ca.OP_TANH)
    with pytest.raises(Untaken, match="operation"):
        over_arrays(ca.Function("one", [X], [ca.tanh(X)]))
