"""The sensitivities of a step of RODAS3, one column after another.

Along a column s of dx/d(x0, p), that of an initial state or of a parameter, the stages change by

    W k_i' = f_x(y_i) y_i' + N_i s + q_i + Σ_j c_ij k_j' / h,    y_i' = s + Σ_j a_ij k_j',
    N_i = d/dx (J k_i + γ_i h f_t),    q_i = f_p(y_i) + d/dp (J k_i + γ_i h f_t),    J = f_x(x), k_i held,
    x⁺' = s + Σ m_i k_i',                                                                (see ``rosenbrock``)

so four systems with the matrix of the step itself. W, f_x and N_i are the same for all columns, q_i is the
parameter's own (zero for an initial state). Against the derivative of the whole step, that takes from what is
computed once, and adds to each column. It pays where several columns are computed side by side.

Source: Hairer, Wanner (1996), Solving Ordinary Differential Equations II, sec. IV.7, differentiated.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import accumulate

import casadi as ca

from hybridid.model import Model
from hybridid.simulation.elimination import Elimination
from hybridid.simulation.rosenbrock import AT_END, SLOPE, A, C, Inputs, M, Rodas3, weighted


@dataclass(frozen=True)
class Column:
    """What maps a column of the sensitivities before a step to the one after it.

    ``system`` is the elimination of W; ``through`` are the f_x of the stages at the end of the step, and
    ``beside`` N_i of every stage, to which those at its start have added their f_x.
    """

    system: Elimination
    through: tuple[ca.SX, ...]
    beside: tuple[ca.SX, ...]

    @property
    def numbers(self) -> ca.SX:
        """All its numbers, (m,)."""
        matrices = (number for one in (*self.through, *self.beside) for number in one.nonzeros())
        return ca.vertcat(self.system.numbers, *matrices)

    def with_numbers(self, numbers: ca.SX) -> Column:
        """The same with other ``numbers`` (m,)."""
        patterns, split = (*self.through, *self.beside), len(self.through)
        sizes = [self.system.numbers.shape[0], *(one.nnz() for one in patterns)]
        of_system, *others = ca.vertsplit(numbers, [0, *accumulate(sizes)])
        matrices = [ca.SX(one.sparsity(), part) for one, part in zip(patterns, others, strict=True)]
        return replace(
            self,
            system=self.system.with_numbers(of_system),
            through=tuple(matrices[:split]),
            beside=tuple(matrices[split:]),
        )

    def along(self, s: ca.SX, q: ca.SX, h: float | ca.SX) -> ca.SX:
        """The column after the step from ``s`` (n_x,) before it; ``q`` (4 n_x,) holds the q_i."""
        own, k = ca.vertsplit(q, s.shape[0]), list[ca.SX]()
        through = iter(self.through)
        for i, at_end in enumerate(AT_END):
            right = self.beside[i] @ s + own[i] + weighted(C[i], k) / h
            if at_end:
                right += next(through) @ (s + weighted(A[i], k))
            k.append(self.system.solve(right))
        return s + weighted(M, k)


def differentiated(
    model: Model, t: ca.SX, h: ca.SX, x: ca.SX, u: Inputs, p: ca.SX, free: Sequence[int]
) -> tuple[ca.SX, Column, ca.SX]:
    """The state after a step, the step's ``Column``, and the q_i (4 n_x, n_free) of the parameters that
    ``free`` numbers."""
    k, system = Rodas3(model).stages(t, h, x, u, p)
    at, rates = _rates(model), _bent(model)
    begins, ends = (t, x, u.first), tuple((t + h, x + weighted(A[i], k[:i]), u.last) for i in (2, 3))
    by_x, by_p = zip(*(at(*place, p) for place in (begins, *ends)), strict=True)
    bent = [rates(t, x, u.first, p, u.slope(h), k[i], SLOPE[i] * h) for i in range(len(k))]
    beside = tuple(one if at_end else one + by_x[0] for (one, _), at_end in zip(bent, AT_END, strict=True))
    own_by_p = (by_p[0], by_p[0], *by_p[1:])
    q = ca.vertcat(
        *(ca.densify((one + by)[:, list(free)]) for (_, one), by in zip(bent, own_by_p, strict=True))
    )
    return x + weighted(M, k), Column(system, tuple(by_x[1:]), beside), q


def _rates(model: Model) -> ca.Function:
    """``(t, x, u, p) -> f_x, f_p``."""
    t, x, u, p = _symbols(model)
    rate = model.f(t, x, u, p)
    return ca.Function("rates", [t, x, u, p], [ca.jacobian(rate, x), ca.jacobian(rate, p)])


def _bent(model: Model) -> ca.Function:
    """``(t, x, u, p, du/dt, k, w) -> N, q`` with ``d/dx`` and ``d/dp`` of ``J k + w f_t``."""
    t, x, u, p = _symbols(model)
    slope, k, weight = ca.SX.sym("du", u.shape[0]), ca.SX.sym("k", x.shape[0]), ca.SX.sym("w")
    rate = model.f(t, x, u, p)
    changed = ca.jtimes(rate, x, k) + weight * ca.jtimes(rate, ca.vertcat(t, u), ca.vertcat(1, slope))
    return ca.Function(
        "bent", [t, x, u, p, slope, k, weight], [ca.jacobian(changed, x), ca.jacobian(changed, p)]
    )


def _symbols(model: Model) -> tuple[ca.SX, ca.SX, ca.SX, ca.SX]:
    sizes = (1, len(model.states), len(model.inputs), len(model.parameters))
    t, x, u, p = (ca.SX.sym(name, n) for name, n in zip("txup", sizes, strict=True))
    return t, x, u, p
