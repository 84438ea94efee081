"""A machine inside its loop: the reference goes in, and the control law closes over the simulated outputs.

At each sample the law reads the outputs with the command that has acted until then, and its new command acts
until the next sample. An output that depends on the command itself is thus read before it changes.
"""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from hybridid.controllers.loop import Loop
from hybridid.model import Model
from hybridid.records.record import Record
from hybridid.simulation.control_law import acting, law_of, readings
from hybridid.simulation.holds import all_held, stage_inputs
from hybridid.simulation.integrators import sample_step
from hybridid.simulation.matching import check_records

Array = NDArray[np.float64]
CALL = 1000
"""Samples that one call of the compiled function simulates."""


@dataclass(frozen=True)
class ClosedRun:
    """A run in the loop: ``states`` (n, n_x), ``outputs`` (n, n_y), ``commands`` (n, n_c) that acted."""

    states: Array
    outputs: Array
    commands: Array


def closed_loop(
    model: Model, p: Array, record: Record, loop: Loop, x0: Array, substeps: int, integrator: str = "rk4"
) -> ClosedRun:
    """Simulate ``model`` at ``p`` (n_p,) from ``x0`` (n_x,) under the law of ``loop``.

    Inputs that the law does not set run as recorded. Until the law has seen its ``memory`` of samples, it
    reads the recorded outputs, and the recorded commands act.

    Raises:
        ValueError: if the record lacks a signal of the model or of the law.
        OwnCodeError: if the controller's code fails.
    """
    check_records(model, [record])
    loop.check(model.inputs, model.outputs)
    n, held = record.n, all_held(record)
    r, y = loop.followed(record), readings(loop, record)
    q = loop.parameters(record.dt)
    carried = np.asarray(law_of(loop).start(r[0], y[0], q)).ravel()
    places = _places(model, loop)
    state = np.concatenate([x0, carried, record.inputs[0, places]])
    closed = (np.arange(n) >= loop.settled).astype(float)
    rows = (
        record.time[None, :], stage_inputs(record, substeps).T, record.inputs.T, r.T, y.T,
        np.vstack([acting(loop, n), closed]),
    )  # fmt: skip
    one = _sample(model, loop, integrator, record.dt, substeps, held)
    found = _run(one, state, rows, (p, q))
    n_x, n_y = len(model.states), len(model.outputs)
    return ClosedRun(found[:, :n_x], found[:, n_x : n_x + n_y], found[:, n_x + n_y :])


def _run(one: ca.Function, state: Array, rows: tuple[Array, ...], constants: tuple[Array, ...]) -> Array:
    """All samples, a number at a call; the last call repeats the last sample."""
    n = rows[0].shape[1]
    many = one.mapaccum("loop", CALL, 1)
    repeated = [np.repeat(c[:, None], CALL, axis=1) for c in constants]
    found = []
    for begin in range(0, n, CALL):
        index = np.minimum(np.arange(begin, begin + CALL), n - 1)
        states, seen = many(state, *(row[:, index] for row in rows), *repeated)
        state = np.asarray(states)[:, -1]
        found.append(np.asarray(seen).T)
    return np.concatenate(found)[:n]


def _sample(model: Model, loop: Loop, integrator: str, dt: float, substeps: int, held: bool) -> ca.Function:
    """``(state, t, U, u, r, y, flags, p, q) -> (state, seen)``, with ``state`` x, what the law carries and
    the last commands, ``flags`` whether the law works and whether the loop is closed, ``seen`` x, y and the
    commands."""
    law, places = law_of(loop), _places(model, loop)
    n_x, n_u, n_c = len(model.states), len(model.inputs), len(places)
    stages = 1 if held else 2 * substeps + 1
    n_carried = law.sample.size1_in(0)
    state, t = ca.SX.sym("state", n_x + n_carried + n_c), ca.SX.sym("t")
    staged, u = ca.SX.sym("U", n_u * stages), ca.SX.sym("u", n_u)
    r, y = ca.SX.sym("r", law.sample.size1_in(1)), ca.SX.sym("y", law.sample.size1_in(2))
    flags, p = ca.SX.sym("flags", 2), ca.SX.sym("p", len(model.parameters))
    q = ca.SX.sym("q", law.sample.size1_in(4))
    x, carried, last = state[:n_x], state[n_x : n_x + n_carried], state[n_x + n_carried :]
    simulated = model.h(t, x, _with(u, places, last), p)
    read = [[s.name for s in model.outputs].index(one.name) for one in loop.controller.outputs]
    seen = ca.vertcat(*[ca.if_else(flags[1], simulated[k], y[i]) for i, k in enumerate(read)])
    carried, command = law.sample(carried, r, seen, flags[0], q)
    acts = ca.vertcat(*[ca.if_else(flags[1], command[i], u[k]) for i, k in enumerate(places)])
    inputs = _with(u, places, acts)
    along = _with(staged, [k + n_u * j for j in range(stages) for k in places], ca.repmat(acts, stages))
    following = sample_step(integrator, model, dt, substeps, held)(t, x, along, p)
    given = [state, t, staged, u, r, y, flags, p, q]
    shown = ca.vertcat(x, model.h(t, x, inputs, p), acts)
    return ca.Function("sample", given, [ca.vertcat(following, carried, acts), shown], {"cse": True})


def _places(model: Model, loop: Loop) -> list[int]:
    """Where the commands stand among the model's inputs."""
    names = [signal.name for signal in model.inputs]
    return [names.index(one.name) for one in loop.controller.commands]


def _with(vector: ca.SX, places: list[int], values: ca.SX) -> ca.SX:
    """``vector`` with ``values`` at ``places``."""
    changed = ca.SX(vector)
    for k, place in enumerate(places):
        changed[place] = values[k]
    return changed
