"""Calls of CasADi functions on numpy memory: a call on CasADi's matrices copies each number several times."""

from __future__ import annotations

from collections.abc import Sequence

import casadi as ca
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def call(function: ca.Function, given: Sequence[Array], shapes: Sequence[tuple[int, ...]]) -> list[Array]:
    """The results of a ``function`` of dense matrices.

    CasADi stores columns: what is (rows, n) there, is a C-ordered (n, rows) in ``given`` and ``shapes``.
    """
    buffer, run = function.buffer()
    arrays = [np.ascontiguousarray(a, dtype=float) for a in given]
    results = [np.empty(shape) for shape in shapes]
    for k, array in enumerate(arrays):
        buffer.set_arg(k, array.data)
    for k, result in enumerate(results):
        buffer.set_res(k, result.data)
    run()
    return results
