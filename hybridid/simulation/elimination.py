"""Gaussian elimination of a small sparse matrix as an explicit formula, for several right sides.

The pivots are on the diagonal. Their order is chosen once from the pattern of zeros, so that there is little
fill-in. In the equations of motion of a machine, most rows only say that the rate of a position is a velocity
and cost almost nothing: the formula and its derivative are three to five times shorter than those of CasADi's
symbolic QR. There is no pivoting by size. For a matrix ``s I - df/dx``, a pivot in any order is a ratio of
characteristic polynomials of parts of the model at s: it is zero only if s is an eigenvalue of a part of the
model whose other states are held constant.

Source: Markowitz (1957), Management Science 3(3), 255-269; Duff, Erisman, Reid (2017), Direct
Methods for Sparse Matrices.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import casadi as ca

Row = dict[int, ca.SX]


@dataclass(frozen=True)
class Pivot:
    """One elimination step: row ``index``, the ``inverse`` of its diagonal, and ``row``, its entries in later
    columns.

    ``multipliers`` are the factors by which it is subtracted from each remaining row.
    """

    index: int
    inverse: ca.SX
    multipliers: Row
    row: Row

    @property
    def numbers(self) -> list[ca.SX]:
        """All its numbers."""
        return [self.inverse, *self.multipliers.values(), *self.row.values()]

    def with_numbers(self, numbers: Iterator[ca.SX]) -> Pivot:
        """The same step with the next of ``numbers``, in the order of its own."""
        inverse = next(numbers)
        multipliers = {i: next(numbers) for i in self.multipliers}
        return Pivot(self.index, inverse, multipliers, {j: next(numbers) for j in self.row})


@dataclass(frozen=True)
class Elimination:
    """``W x = b``: the pivots of W (n, n) in their order."""

    pivots: tuple[Pivot, ...]

    @classmethod
    def of(cls, matrix: ca.SX) -> Elimination:
        """The elimination of ``matrix`` (n, n), with the pivots in Markowitz order."""
        n, pattern = matrix.shape[0], matrix.sparsity()
        rows: list[Row] = [{j: matrix[i, j] for j in range(n) if pattern.has_nz(i, j)} for i in range(n)]
        left, pivots = list(range(n)), []
        while left:
            index = _cheapest(rows, left)
            left.remove(index)
            pivots.append(_eliminate(rows, left, index))
        return cls(tuple(pivots))

    @property
    def numbers(self) -> ca.SX:
        """All that ``solve`` needs of W, (m,)."""
        return ca.vertcat(*(number for pivot in self.pivots for number in pivot.numbers))

    def with_numbers(self, numbers: ca.SX) -> Elimination:
        """The elimination of a matrix of the same pattern, of which these are the ``numbers`` (m,)."""
        each = iter(ca.vertsplit(numbers))
        return Elimination(tuple(pivot.with_numbers(each) for pivot in self.pivots))

    def solve(self, right: ca.SX) -> ca.SX:
        """x (n,) for the right side b (n,)."""
        b = [right[i] for i in range(len(self.pivots))]
        for pivot in self.pivots:
            for i, multiplier in pivot.multipliers.items():
                b[i] = b[i] - multiplier * b[pivot.index]
        for pivot in reversed(self.pivots):
            rest = sum((value * b[j] for j, value in pivot.row.items()), ca.SX(0))
            b[pivot.index] = (b[pivot.index] - rest) * pivot.inverse
        return ca.vertcat(*b)


def _cheapest(rows: Sequence[Row], left: Sequence[int]) -> int:
    """The row whose elimination needs the fewest multiplications (Markowitz)."""

    def products(k: int) -> int:
        return sum(j in rows[k] for j in left if j != k) * sum(k in rows[i] for i in left if i != k)

    return min(left, key=products)


def _eliminate(rows: list[Row], left: Sequence[int], index: int) -> Pivot:
    own = {j: value for j, value in rows[index].items() if j in left}
    inverse, multipliers = 1 / rows[index][index], {}
    for i in left:
        if index in rows[i]:
            multipliers[i] = rows[i][index] * inverse
            for j, value in own.items():
                rows[i][j] = rows[i].get(j, ca.SX(0)) - multipliers[i] * value
    return Pivot(index, inverse, multipliers, own)
