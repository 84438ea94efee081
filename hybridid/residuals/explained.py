"""How much of a network's output the physical parameters could have explained.

A network must not hide physics. Its contribution r is projected onto the changes that the model's own
parameters can make,

    share = 1 - min over c of |r - S c|² / |r|²,   S = columns d(output)/dp or d(acceleration)/dp,

both along one trajectory. If the share is near 1, other parameter values have the same effect as the network.
If it is near 0, the network represents something else. The squares are about zero, not about the mean: a
constant that an offset could give counts as explained.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Generic, TypeVar

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from hybridid.estimators.problem import build_problem
from hybridid.model import Model
from hybridid.records.record import Record
from hybridid.simulation.stability import substeps_for
from hybridid.validation.predict import Prediction

Array = NDArray[np.float64]
T = TypeVar("T")
MUCH = 0.5
"""Share above which there is a warning."""
NEGLIGIBLE = 1e-10
"""Directions of S with a smaller singular value, relative to the largest, are ignored."""


@dataclass(frozen=True)
class Explained:
    """``share`` (0 to 1) of a network's mean square; ``alone`` the share that each parameter
    explains by itself; ``changes`` the parameter changes that explain the share together."""

    share: float
    alone: Mapping[str, float]
    changes: Mapping[str, float]
    record: str
    provenance: str

    @property
    def warning(self) -> str | None:
        """One line if the model's own parameters could explain much of the network, else None."""
        if not self.share > MUCH:
            return None
        most = max(self.alone, key=lambda name: self.alone[name])
        return (
            f"the model's own parameters could have explained {self.share:.0%} of the network's output "
            f"({most} alone {self.alone[most]:.0%}): the two share it, so read neither by itself"
        )


def explained_share(
    correction: Array, sensitivities: Array, names: Sequence[str]
) -> tuple[float, Array, Array]:
    """Projects ``correction`` (n,) on ``sensitivities`` (n, k): share, share of each column, coefficients."""
    total = float(correction @ correction)
    sizes = np.linalg.norm(sensitivities, axis=0)
    columns = sensitivities / np.where(sizes > 0, sizes, 1.0)
    if total == 0 or not len(names):
        return 0.0, np.zeros(len(names)), np.zeros(len(names))
    u, s, vt = np.linalg.svd(columns, full_matrices=False)
    kept = s > NEGLIGIBLE * max(s[0], np.finfo(float).tiny)
    along = u[:, kept].T @ correction
    scaled = vt[kept].T @ (along / s[kept])
    coefficients = np.where(sizes > 0, scaled / np.where(sizes > 0, sizes, 1.0), 0.0)
    return float(along @ along) / total, (columns.T @ correction) ** 2 / total, coefficients


def output_explained(
    model: Model,
    values: Mapping[str, float],
    record: Record,
    prediction: Prediction,
    correction: Array,
    integrator: str = "rk4",
) -> Explained:
    """How much of an output ``correction`` (n, n_y) the sensitivities ``dy/dp`` of the model explain,
    p its free parameters.

    ``prediction`` is the model's free run of ``record``; each output counts over its spread.
    """
    columns, scale = _sensitivities(Same(model), tuple(values.items()), record, Same(prediction), integrator)
    names = [q.name for q in model.free]
    n = len(correction)
    along = columns[:n].reshape(-1, len(names))
    return _explained(explained_share((correction / scale).ravel(), along, names), names, record)


@dataclass(frozen=True, eq=False)
class Same(Generic[T]):
    """A cache key for the object ``value`` itself: equal only if it is the same object."""

    value: T

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Same) and other.value is self.value

    def __hash__(self) -> int:
        return id(self.value)


@lru_cache(maxsize=4)
def _sensitivities(
    of: Same[Model],
    values: tuple[tuple[str, float], ...],
    record: Record,
    along: Same[Prediction],
    integrator: str,
) -> tuple[Array, Array]:
    """``dy/dp`` (n, n_y, k) over the outputs' spread, and that spread (n_y,).

    Kept for the next network: the networks of a sweep on one gray box differ only in the correction.
    """
    model, prediction = of.value, along.value
    p = model.values(dict(values))
    names = [q.name for q in model.free]
    substeps = substeps_for(model, p, [record], integrator=integrator)
    problem = build_problem(model, [record], None, substeps, free=names, integrator=integrator)
    shot = problem.shooter(prediction.initial_states, p, sensitivities=True)
    if shot.by_parameter is None:
        raise AssertionError("a shot with sensitivities has them")
    return shot.by_parameter[0] / problem.scale[:, None], problem.scale


def effort_explained(
    model: Model,
    term: str,
    names: Sequence[str],
    values: Mapping[str, float],
    record: Record,
    prediction: Prediction,
) -> Explained:
    """How much of what ``term`` does to its port's acceleration the parameters ``names`` explain.

    ``prediction`` is a run of ``model``, the term included, over ``record``. Where the moving mass is
    constant this is the share of the term's effort.
    """
    n = len(prediction.time)
    pushed, by_parameter = _port_acceleration(model, term, names)
    along = (
        prediction.time[None, :],
        prediction.states.T,
        prediction.of(record.inputs).T,
        ca.repmat(ca.DM(model.values(values)), 1, n),
    )
    correction = pushed.map(n)(*along).full().ravel()
    columns = by_parameter.map(n)(*along).full().T
    return _explained(explained_share(correction, columns, names), names, record)


def _explained(found: tuple[float, Array, Array], names: Sequence[str], record: Record) -> Explained:
    share, alone, changes = found
    return Explained(
        share=share,
        alone=dict(zip(names, map(float, alone), strict=True)),
        changes=dict(zip(names, map(float, changes), strict=True)),
        record=record.name,
        provenance=record.provenance,
    )


def _port_acceleration(model: Model, term: str, names: Sequence[str]) -> tuple[ca.Function, ca.Function]:
    """``(t, x, u, p) -> `` what ``term`` adds to its port's acceleration, and d(acceleration)/dp (k,)."""
    where = next(t for t in model.terms if t.name == term)
    index = [q.name for q in model.equation_ports].index(where.port)
    port = model.equation_ports[index]
    t, x = ca.SX.sym("t"), ca.SX.sym("x", len(model.states))
    u, p = ca.SX.sym("u", len(model.inputs)), ca.SX.sym("p", len(model.parameters))
    moved = model.motions(t, x, u, p)[index, port.moved]
    acceleration = ca.jtimes(moved, x, model.f(t, x, u, p))  # at a flow port the rate of the level
    order = [q.name for q in model.parameters]
    off = ca.SX(p)
    for q in where.effect.parameters:
        if q.nests:
            off[order.index(f"{term}.{q.name}")] = 0.0
    without = ca.substitute(acceleration, p, off)
    slope = ca.jacobian(without, p)[:, [order.index(name) for name in names]]
    arguments = [t, x, u, p]
    return (
        ca.Function("pushed", arguments, [acceleration - without]),
        ca.Function("by_parameter", arguments, [ca.densify(slope).T]),
    )
