"""A control law as a CasADi function of one sample, and its commands along the recorded outputs."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import SimpleNamespace

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from hybridid.blame import Named, blamed_on
from hybridid.controllers.controller import PERIOD, Controller
from hybridid.controllers.loop import Loop
from hybridid.model.asked import check_numbers, scalars_of
from hybridid.records.record import Record

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Law:
    """``start(r, y, p) -> carried``; ``sample(carried, r, y, acts, p) -> (carried, u)``.

    ``carried`` holds the law's states, its last command, and the commands that wait for their delay. The law
    works where ``acts`` is 1. ``u`` (n_c,) are the commands that act now, ``y`` the outputs that it reads.
    """

    start: ca.Function
    sample: ca.Function


def law_of(loop: Loop) -> Law:
    """The law of ``loop`` with its delay and its hold.

    Raises:
        OwnCodeError: if the controller's code fails, or gives something else than equations.
    """
    law = loop.controller
    r, reference = _symbols("reference", [one.name for one in law.references])
    y, outputs = _symbols("output", [one.name for one in law.outputs])
    s, state = _symbols("state", [one.name for one in law.states])
    p, known = _symbols("parameter", [*(one.name for one in law.parameters), PERIOD])
    at = (reference, outputs, state, known)
    names = [one.name for one in law.states]
    commands = scalars_of(law.command, [one.name for one in law.commands], "command", *at)
    following = scalars_of(law.update, names, "state", *at)
    first = _first(law, reference, outputs, known)
    n_c = len(law.commands)
    held, acts = ca.SX.sym("held", n_c), ca.SX.sym("acts")
    waiting = ca.SX.sym("waiting", n_c * loop.delay)
    new = _either(acts, ca.vertcat(*commands.values()), held)
    queue = ca.vertsplit(ca.vertcat(waiting, new))
    carried = ca.vertcat(s, held, waiting)
    left = ca.vertcat(_either(acts, ca.vertcat(*following.values()), s), new, *queue[n_c:])
    with blamed_on(law):  # a symbol of its own that is none of the arguments
        start = ca.Function(
            "start", [r, y, p], [ca.vertcat(*first.values(), ca.SX.zeros(n_c + waiting.numel()))]
        )
        sample = ca.Function("law", [carried, r, y, acts, p], [left, ca.vertcat(*queue[:n_c])], {"cse": True})
    for function in (start, sample):
        check_numbers(function, law, f"the equations of controller {law.name}")
    return Law(start, sample)


def replayed(loop: Loop, record: Record) -> Array:
    """The commands (n, n_c) of the law along the *recorded* references and outputs.

    Raises:
        ValueError: if the record lacks a signal.
        OwnCodeError: as ``law_of``.
    """
    law, p = law_of(loop), loop.parameters(record.dt)
    r, y = loop.followed(record), readings(loop, record)
    carried = law.start(r[0], y[0], p)
    columns = law.sample.mapaccum("replay", record.n, 1)
    _, u = columns(carried, r.T, y.T, acting(loop, record.n)[None, :], np.repeat(p[:, None], record.n, 1))
    return np.asarray(u).T


def readings(loop: Loop, record: Record) -> Array:
    """The recorded outputs that the law reads, (n, n_read)."""
    return np.column_stack([record.output(one.name) for one in loop.controller.outputs])


def acting(loop: Loop, n: int) -> Array:
    """1 at the samples (n,) at which the law works, 0 at the others."""
    return (np.arange(n) % loop.every == loop.phase % loop.every).astype(float)


def _first(
    law: Controller, reference: SimpleNamespace, outputs: SimpleNamespace, p: SimpleNamespace
) -> dict[str, ca.SX]:
    """The states at the first sample; zero for those that ``start`` leaves out."""
    names = [state.name for state in law.states]
    with blamed_on(law.start):
        given = law.start(reference, outputs, p)
    chosen = [name for name in names if name in given] if isinstance(given, Mapping) else names
    found = scalars_of(law.start, chosen, "state", reference, outputs, p)
    return {name: found.get(name, ca.SX(0)) for name in names}


def _symbols(what: str, names: list[str]) -> tuple[ca.SX, SimpleNamespace]:
    symbols = [ca.SX.sym(name) for name in names]
    vector = ca.vertcat(*symbols) if symbols else ca.SX(0, 1)
    return vector, Named(what, dict(zip(names, symbols, strict=True)))


def _either(condition: ca.SX, one: ca.SX, other: ca.SX) -> ca.SX:
    """Elementwise; what is not chosen may be no number."""
    pairs = zip(ca.vertsplit(one), ca.vertsplit(other), strict=True) if one.numel() else ()
    return ca.vertcat(*[ca.if_else(condition, a, b) for a, b in pairs]) if one.numel() else ca.SX(0, 1)
