"""Efforts that resist at a port: of each effect from the model, and their sum from the record.

The motion of a port obeys ``a = a_0 - g F``, affine in the effort F that resists it. With the
acceleration a from the record, and a_0, g from the model, ``F = (a_0 - a) / g``. Source: inverse
dynamics, Janot, Gautier, Brunot (2019), Eq. (5). At a flow port, a is the rate of the level and F the
flow that leaves.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from hybridid.declarations import Port
from hybridid.effects.dimension import Dimension
from hybridid.effects.effect import Effect, EffectParameter
from hybridid.model import Model
from hybridid.records.record import Record
from hybridid.simulation.initial import measured_states, output_derivative, telling
from hybridid.validation.predict import Prediction

Array = NDArray[np.float64]
HALF_WIDTH = 25
"""Samples on each side that the smoothing polynomial of the acceleration uses."""
PROBE = Effect(
    id="probe",
    kind="effort",
    title="unit effort",
    equation="F = unit",
    law=lambda at: at.p.unit,
    parameters=(EffectParameter("unit", Dimension(effort=1), "effort that is tried", guess=0.0, nests=True),),
    source="this module",
    pattern="none: it only measures how a port answers an effort",
)


@dataclass(frozen=True)
class PortEfforts:
    """Efforts of a port's terms by name, each (n,), ``over`` (n,) the port's velocity, or level.

    ``static``: they depend on that alone, so that the order of the samples does not matter.
    """

    port: Port
    over: Array
    efforts: Mapping[str, Array]
    static: bool


def port_efforts(
    model: Model, values: Mapping[str, float], record: Record, prediction: Prediction
) -> list[PortEfforts]:
    """The efforts along a predicted trajectory, one entry for each port that has terms."""
    n = len(prediction.time)
    p = ca.repmat(ca.DM(model.values(values)), 1, n)
    along = (prediction.time[None, :], prediction.states.T, prediction.of(record.inputs).T, p)
    efforts, motions = (function.map(n)(*along).full() for function in (model.efforts, model.motions))
    found = []
    for index, port in enumerate(model.equation_ports):
        rows = [k for k, (_, where) in enumerate(model.effort_places) if where == port.name]
        if rows:
            over = motions.reshape(len(model.equation_ports), n, 2)[index, :, port.moved]
            by_name = {model.effort_places[k][0].name: efforts[k] for k in rows}
            found.append(PortEfforts(port, over, by_name, _static(model, index, rows)))
    return found


def resisting_effort(
    model: Model, values: Mapping[str, float], record: Record, port: Port
) -> tuple[Array, Array] | None:
    """Velocity (or level) and resisting effort (m,) at a port, from the record; None where a state is not
    observed."""
    if any(state.observed_by is None for state in model.states):
        return None
    width = min(HALF_WIDTH, (record.n - 1) // 4)
    inner = np.arange(width, record.n - width)
    inner = inner[telling(record)[inner]] if record.partly else inner
    x = measured_states(model, record, width)[inner]
    measured = [output_derivative(record, str(s.observed_by), s.derivative + 1, width) for s in model.states]
    rates = np.stack(measured, axis=1)[inner]
    elsewhere = tuple(t for t in model.terms if port.name not in t.ports)
    bare = replace(model, terms=elsewhere, adjustments={}).plus(replace(PROBE, kind=port.kind), port.name)
    known = {p.name for p in bare.parameters}
    inherited = {name: value for name, value in values.items() if name in known}
    motion = _port_motion(bare, [p.name for p in bare.equation_ports].index(port.name), len(x))
    unit = port.effort_scale
    without, within = (
        motion(
            record.time[None, inner],
            x.T,
            record.inputs[inner].T,
            rates.T,
            bare.values({**inherited, name: effort}),
        )
        for name, effort in ((f"{port.name}.probe.unit", 0.0), (f"{port.name}.probe.unit", unit))
    )
    over, acceleration, free = without.full()
    gain = (free - within.full()[2]) / unit
    return over, (free - acceleration) / gain


def _port_motion(model: Model, index: int, n: int) -> ca.Function:
    """``(t, x, u, x', p) -> (3, n)``: velocity (or level) of a port, its rate from x' and from the model."""
    n_x = len(model.states)
    t, x, rate = ca.SX.sym("t"), ca.SX.sym("x", n_x), ca.SX.sym("r", n_x)
    u, p = ca.SX.sym("u", len(model.inputs)), ca.SX.sym("p", len(model.parameters))
    moved = model.motions(t, x, u, p)[index, model.equation_ports[index].moved]
    by_record, by_model = (ca.jtimes(moved, x, r) for r in (rate, model.f(t, x, u, p)))
    one = ca.Function("motion", [t, x, u, rate, p], [ca.vertcat(moved, by_record, by_model)])
    many = one.map(n)
    symbols = [ca.MX.sym(name, v.numel(), n) for name, v in (("t", t), ("x", x), ("u", u), ("r", rate))]
    q = ca.MX.sym("p", len(model.parameters))
    return ca.Function("motions", [*symbols, q], [many(*symbols, ca.repmat(q, 1, n))])


def _static(model: Model, index: int, rows: list[int]) -> bool:
    """Whether the efforts depend only on states on which the port's velocity (or level) depends."""
    by_time, by_input = (_columns(model.efforts.jac_sparsity(0, k), rows) for k in (0, 2))
    if by_time or by_input:
        return False
    by_effort = _columns(model.efforts.jac_sparsity(0, 1), rows)
    ports = model.equation_ports
    row = len(ports) * ports[index].moved + index  # motions is (n_ports, 2), column-major
    return by_effort <= _columns(model.motions.jac_sparsity(0, 1), [row])


def _columns(sparsity: ca.Sparsity, rows: list[int]) -> set[int]:
    """Columns with an entry in one of ``rows``."""
    at_rows, at_columns = sparsity.get_triplet()
    return {column for row, column in zip(at_rows, at_columns, strict=True) if row in rows}
