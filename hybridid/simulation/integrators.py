"""One step of an integrator: ``x_next = step(t, x, U, p)`` as a CasADi function, and several steps a sample.

``U`` holds the inputs. For a step, they are (n_u,) if held, else (3 n_u,) at its start, middle and end. For a
sample of s steps, they are (n_u,) or (n_u (2 s + 1),) in the order of ``holds.stage_inputs``.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TypeAlias

import casadi as ca

from hybridid.model import Model
from hybridid.simulation.rosenbrock import Inputs, Rodas3

Seconds: TypeAlias = float | ca.SX
StepBuilder = Callable[[Model, Seconds, bool], ca.Function]
"""``(model, h, held) -> step``; a symbolic h becomes a further input of the step."""
Rate = Callable[[int, ca.SX], ca.SX]
"""``(i, x) -> dx/dt`` at stage i of a method."""
RK4_TIMES = (0.0, 0.5, 0.5, 1.0)
"""When the stages of ``rk4`` are, over the step."""


def rk4(rate: Rate, x: ca.SX, h: Seconds) -> ca.SX:
    """The state after a step of the classical fourth-order Runge-Kutta method.

    Stable while |eigenvalue| times step stays below 2.78. Source: thesis sec. 3.1.
    """
    k1 = rate(0, x)
    k2 = rate(1, x + h / 2 * k1)
    k3 = rate(2, x + h / 2 * k2)
    k4 = rate(3, x + h * k3)
    return x + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)


def rk4_step(model: Model, h: Seconds, held: bool) -> ca.Function:
    """One step of ``rk4``."""

    def step(t: ca.SX, x: ca.SX, u: Inputs, p: ca.SX) -> ca.SX:
        return rk4(lambda i, y: model.f(t + RK4_TIMES[i] * h, y, u.at(RK4_TIMES[i]), p), x, h)

    return _function(model, h, held, step)


def rodas3_step(model: Model, h: Seconds, held: bool) -> ca.Function:
    """The linearly implicit method ``rosenbrock.Rodas3``.

    L-stable: only accuracy, not stiffness, limits the step.
    """
    method = Rodas3(model)
    return _function(model, h, held, lambda t, x, u, p: method.step(t, h, x, u, p))


INTEGRATORS: Mapping[str, StepBuilder] = {"rk4": rk4_step, "rodas3": rodas3_step}
"""Ways to integrate one step, by the name that a config gives."""


def sample_step(integrator: str, model: Model, dt: float, substeps: int, held: bool) -> ca.Function:
    """``substeps`` steps as one function of the sample's inputs."""
    n_u = len(model.inputs)
    t, x, p = _symbols(model)
    u = ca.SX.sym("U", n_u if held else n_u * (2 * substeps + 1))
    h = dt / substeps
    step = INTEGRATORS[integrator](model, h, held)
    state = x
    for i in range(substeps):
        state = step(t + i * h, state, u if held else u[2 * i * n_u : (2 * i + 3) * n_u], p)
    return ca.Function("sample", [t, x, u, p], [state], ["t", "x", "U", "p"], ["x_next"], {"cse": True})


def _function(
    model: Model, h: Seconds, held: bool, step: Callable[[ca.SX, ca.SX, Inputs, ca.SX], ca.SX]
) -> ca.Function:
    """A one-step method as a function of the step's inputs."""
    t, x, p = _symbols(model)
    u = ca.SX.sym("U", len(model.inputs) * (1 if held else 3))
    x_next = step(t, x, Inputs.of(u, held), p)
    given, names = [t, x, u, p], ["t", "x", "U", "p"]
    if isinstance(h, ca.SX):
        given, names = [*given, h], [*names, "h"]
    return ca.Function("step", given, [x_next], names, ["x_next"], {"cse": True})


def _symbols(model: Model) -> tuple[ca.SX, ca.SX, ca.SX]:
    return ca.SX.sym("t"), ca.SX.sym("x", len(model.states)), ca.SX.sym("p", len(model.parameters))
