"""One sample of time, integrated: ``x_next = step(t, x, U, p)`` as a CasADi function.

``U`` holds the inputs of the sample: (n_u,) when they are held, else (n_u (2 s + 1),) at the
stages, as ``holds.stage_inputs`` lays them out for s steps a sample.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping

import casadi as ca

from hybridid.model import Model
from hybridid.simulation.rosenbrock import Inputs, Rodas3

StepBuilder = Callable[[Model, float, int, bool], ca.Function]
"""``(model, dt, substeps, held) -> step``."""


def rk4_step(model: Model, dt: float, substeps: int, held: bool) -> ca.Function:
    """The classical fourth-order Runge-Kutta method, ``substeps`` steps a sample.

    Stable while |eigenvalue| times step stays below 2.78. Source: thesis sec. 3.1.
    """

    def step(t: ca.SX, h: float, x: ca.SX, u: Inputs, p: ca.SX) -> ca.SX:
        k1 = model.f(t, x, u.first, p)
        k2 = model.f(t + h / 2, x + h / 2 * k1, u.middle, p)
        k3 = model.f(t + h / 2, x + h / 2 * k2, u.middle, p)
        k4 = model.f(t + h, x + h * k3, u.last, p)
        return x + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)

    return _sample(model, dt, substeps, held, step)


def rodas3_step(model: Model, dt: float, substeps: int, held: bool) -> ca.Function:
    """The linearly implicit method ``rosenbrock.Rodas3``, ``substeps`` steps a sample.

    L-stable: stiffness costs it no steps, only accuracy does.
    """
    return _sample(model, dt, substeps, held, Rodas3(model).step)


INTEGRATORS: Mapping[str, StepBuilder] = {"rk4": rk4_step, "rodas3": rodas3_step}
"""Ways to integrate one sample, by the name that a config gives."""


def _sample(
    model: Model,
    dt: float,
    substeps: int,
    held: bool,
    step: Callable[[ca.SX, float, ca.SX, Inputs, ca.SX], ca.SX],
) -> ca.Function:
    """``substeps`` steps of a one-step method as one function of the sample's inputs."""
    n_u = len(model.inputs)
    t, x = ca.SX.sym("t"), ca.SX.sym("x", len(model.states))
    p = ca.SX.sym("p", len(model.parameters))
    u = ca.SX.sym("U", n_u if held else n_u * (2 * substeps + 1))
    h = dt / substeps

    def at(index: int) -> ca.SX:
        return u if held else u[n_u * index : n_u * (index + 1)]

    state = x
    for i in range(substeps):
        state = step(t + i * h, h, state, Inputs(at(2 * i), at(2 * i + 1), at(2 * i + 2)), p)
    return ca.Function("step", [t, x, u, p], [state], ["t", "x", "U", "p"], ["x_next"], {"cse": True})
