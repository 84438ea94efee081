"""One sample of time, integrated: ``x_next = step(t, x, U, p)`` as a CasADi function."""

from __future__ import annotations

import casadi as ca

from hybridid.model import Model


def rk4_step(model: Model, dt: float, substeps: int, held: bool) -> ca.Function:
    """The classical fourth-order Runge-Kutta method, ``substeps`` steps a sample.

    ``U`` holds the inputs of the sample: (n_u,) when ``held``, else (n_u (2 s + 1),) at
    the stages, as ``holds.stage_inputs`` lays them out. Source: thesis sec. 3.1.
    """
    n_u = len(model.inputs)
    t, x = ca.SX.sym("t"), ca.SX.sym("x", len(model.states))
    p = ca.SX.sym("p", len(model.parameters))
    u = ca.SX.sym("U", n_u if held else n_u * (2 * substeps + 1))
    h = dt / substeps

    def stage(index: int) -> ca.SX:
        return u if held else u[n_u * index : n_u * (index + 1)]

    state = x
    for i in range(substeps):
        start = t + i * h
        first, middle, last = stage(2 * i), stage(2 * i + 1), stage(2 * i + 2)
        k1 = model.f(start, state, first, p)
        k2 = model.f(start + h / 2, state + h / 2 * k1, middle, p)
        k3 = model.f(start + h / 2, state + h / 2 * k2, middle, p)
        k4 = model.f(start + h, state + h * k3, last, p)
        state = state + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
    return ca.Function("step", [t, x, u, p], [state], ["t", "x", "U", "p"], ["x_next"], {"cse": True})


INTEGRATORS = {"rk4": rk4_step}
"""Ways to integrate one sample, by the name that a config gives."""
