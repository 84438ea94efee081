"""A call on numpy memory gives CasADi's numbers."""

from __future__ import annotations

import casadi as ca
import numpy as np

from hybridid.simulation.buffers import call


def test_the_numbers_of_casadi_as_rows():
    x, p = ca.SX.sym("x", 2, 3), ca.SX.sym("p", 2)
    function = ca.Function("f", [x, p], [ca.densify(ca.repmat(p, 1, 3) * x), ca.densify(ca.sum1(x))])
    columns, p = np.arange(6.0).reshape(3, 2), np.array([10.0, 100.0])
    product, total = call(function, (columns, p), [(3, 2), (3,)])
    np.testing.assert_array_equal(product, columns * p)
    np.testing.assert_array_equal(total, columns.sum(axis=1))
    np.testing.assert_array_equal(product.T, np.array(function(columns.T, p)[0]))
