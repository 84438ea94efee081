"""IPOPT, an interior-point method, on a problem transcribed into a nonlinear program.

    min f(w)  subject to  g(w) = 0  and bounds:   the bounds become a logarithmic barrier, whose weight falls.

Its Newton steps need the Hessian of the Lagrangian: the exact one, or the Gauss-Newton one ``J' J`` of the
residuals' Jacobian. The latter leaves out the curvature of the gap constraints. Where the residual is not
small, its iterations may circle about the optimum, and those with the exact Hessian converge. Source:
Wächter, Biegler (2006), Math. Program. 106, 25-57.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from hybridid.estimators.estimate import Solution
from hybridid.estimators.multiple_shooting import MultipleShooting
from hybridid.estimators.problem import Problem
from hybridid.estimators.reduced import Reduced
from hybridid.estimators.stop import Stop, Watch

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Ipopt:
    """IPOPT with the Hessian "exact" or "gauss_newton"."""

    hessian: str = "exact"
    solves: ClassVar[tuple[type, ...]] = (Reduced, MultipleShooting)
    hands_on: ClassVar[bool] = False
    """Whether inner states run on from horizon to horizon during the descent."""

    def solve(
        self,
        transcription: Reduced | MultipleShooting,
        problem: Problem,
        p: Array,
        x0: Array,
        factors: Sequence[float],
        stop: Stop,
        watch: Watch | None,
    ) -> Solution:
        """Minimise the cost from ``p`` (n_p,), ``x0`` (w, n_x); one solve for each of ``factors``, from the
        nodes of the one before."""
        program = transcription.program(problem, p, x0)
        nlp, gauss_newton = program.nlp()
        callback = _Watch(nlp["x"].shape[0], len(program.gap_rows), watch) if watch else None
        options = _options(stop, callback)
        if self.hessian == "gauss_newton":
            options["hess_lag"] = gauss_newton
        solver = ca.nlpsol("fit", "ipopt", nlp, options)
        lower, upper, variables = program.bounds(p)
        iterations, history = 0, []
        for factor in factors:
            result = solver(x0=variables, p=problem.smoothed(p, factor), lbx=lower, ubx=upper, lbg=0, ubg=0)
            variables = np.asarray(result["x"]).ravel()
            stats = solver.stats()
            iterations += int(stats["iter_count"])
            history = stats.get("iterations", {}).get("obj", [])
        q, nodes = program.unpack(variables, problem.smoothed(p, factors[-1]))
        begin = nodes[program.intervals.first]
        cost = problem.cost(problem.shooter(begin, q))
        status = _status(stats["return_status"])
        return Solution(
            q, begin, cost, status, bool(stats["success"]), iterations, tuple(map(float, history))
        )


def _status(returned: str) -> str:
    plain = {"Solve_Succeeded": "converged", "Solved_To_Acceptable_Level": "converged (acceptable level)"}
    return plain.get(returned, returned.replace("_", " ").lower())


def _options(stop: Stop, callback: ca.Callback | None) -> dict[str, object]:
    options: dict[str, object] = {
        "print_time": False,
        "ipopt.print_level": 0,
        "ipopt.sb": "yes",
        "ipopt.linear_solver": "mumps",
        "ipopt.max_iter": stop.iterations,
        "ipopt.tol": stop.tolerance,
        "ipopt.nlp_scaling_method": "none",
        "ipopt.mu_strategy": "monotone",
        # closed gaps and a cost that stands still are the optimum, whatever rounding leaves of its gradient
        "ipopt.acceptable_tol": 1e-2,
        "ipopt.acceptable_dual_inf_tol": 1e-2,
        "ipopt.acceptable_compl_inf_tol": 1e-4,
        "ipopt.acceptable_constr_viol_tol": 1e-6,
        "ipopt.acceptable_obj_change_tol": stop.tolerance,
        "ipopt.acceptable_iter": 2,
    }
    if callback is not None:
        options["iteration_callback"] = callback
    return options


class _Watch(ca.Callback):
    """Hands IPOPT's iterations on to ``watch(iteration, cost)``."""

    def __init__(self, n: int, m: int, watch: Watch) -> None:
        ca.Callback.__init__(self)
        self.n, self.m, self.watch, self.iteration = n, m, watch, 0
        self.construct("watch", {})

    def get_n_in(self) -> int:
        return int(ca.nlpsol_n_out())

    def get_n_out(self) -> int:
        return 1

    def get_sparsity_in(self, i: int) -> ca.Sparsity:
        sizes = {"x": self.n, "lam_x": self.n, "g": self.m, "lam_g": self.m, "f": 1}
        return ca.Sparsity.dense(sizes.get(ca.nlpsol_out(i), 0), 1)

    def eval(self, arg: list[ca.DM]) -> list[int]:
        self.iteration += 1
        self.watch(self.iteration, float(arg[ca.nlpsol_out().index("f")]))
        return [0]
