"""The effort or flow missing at a port, over time, with an uncertainty band.

    x' = f(t, x, u, p) with the port's resisting effort raised by w,   w a random walk

A smoother finds the w(t) that makes the model agree with the record: an input estimated in
simulation, never a second derivative of noise. The model is linearised about the states that the
record shows, then about the smoothed ones until they no longer change; each time the walk's intensity
maximises the innovations' likelihood. (Linearised about the model's own prediction, which lacks
the missing effort, the walk would also contain the error of the linearisation.)

Source: Rauch, Tung, Striebel (1965), AIAA J. 3(8), 1445-1450; Särkkä (2013), Bayesian Filtering
and Smoothing, ch. 5 and 12; the augmented input is the "disturbance model" of Muske, Badgwell
(2002), J. Process Control 12(5).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from hybridid.declarations import Port, PortKind
from hybridid.effects.dimension import Dimension
from hybridid.effects.effect import Effect, EffectParameter, EffectState
from hybridid.model import Model
from hybridid.records.record import Record
from hybridid.records.sensor_noise import noise_level
from hybridid.simulation.holds import all_held, stage_inputs
from hybridid.simulation.integrators import sample_step
from hybridid.simulation.stability import substeps_for
from hybridid.simulation.unobserved import filled_states
from hybridid.trace.ports.rest import held_at_rest
from hybridid.validation.predict import holes_of

Array = NDArray[np.float64]
INTENSITIES = np.logspace(-4, 2, 13)
"""Standard deviation of the walk over one time scale of the port, in its effort scale."""
NEAR = 3
"""Steps of the grid that the intensity may move from one pass to the next."""
PASSES, STILL = 5, 0.1
"""Linearisations at most, and the share of its standard deviation by which the effort may still move."""
SINCE_REVERSAL = "travel since the last reversal"

WALK = Effect(
    id="missing_effort",
    kind="effort",
    title="missing effort",
    equation="F = g w, w a random walk",
    law=lambda at: at.p.g * at.z.w,
    dynamics=lambda at: {"w": ca.SX(0)},
    parameters=(EffectParameter("g", Dimension(), "switch", guess=1.0, nests=True),),
    states=(EffectState("w", Dimension(effort=1), "missing effort"),),
    source="Särkkä (2013), ch. 12",
    pattern="whatever the model lacks at this port",
)


@dataclass(frozen=True)
class MissingEffort:
    """``effort`` (n,) that resists at ``port`` beyond the model, and its ``std`` (n,), in ``unit``.

    ``kind`` is that of the port: at a flow port, ``effort`` is a flow that leaves. ``motion`` holds values
    (n,) and unit, by name, of what the effort could depend on: the smoothed velocity, position, acceleration,
    and the travel since the velocity last changed sign; at a flow port the level and the net flow. ``rows``
    (n,) are the samples of the record that it shows, if not all: those that count, in motion. ``rests``: dry
    friction holds the machine at rest at some others.
    """

    record: str
    provenance: str
    port: str
    kind: PortKind
    unit: str
    time: Array
    effort: Array
    std: Array
    motion: Mapping[str, tuple[Array, str]]
    intensity: float
    rows: NDArray[np.int64] | None = None
    rests: bool = False

    def of(self, values: Array) -> Array:
        """Of ``values`` (n of the record,) those at the samples that it shows, (n,)."""
        return values[: len(self.time)] if self.rows is None else values[self.rows]

    @property
    def holes(self) -> Array:
        """Times [s] of the last sample before and the first after each stretch that is left out, (h, 2)."""
        return np.empty((0, 2)) if self.rows is None else holes_of(self.time, self.rows)


def missing_effort(model: Model, values: Mapping[str, float], record: Record, port: str) -> MissingEffort:
    """Estimate the effort that ``model`` at ``values`` lacks at an effort port, or the flow at a flow port.

    Masked outputs say nothing of it. Of a record with masked stretches that are not simulated, it is that of
    the longest part between them. Where dry friction holds the machine at rest, nothing is shown.

    Raises:
        ValueError: if the port takes neither, or the machine always rests.
        ArithmeticError: if the smoother diverges.
    """
    from hybridid.trace.ports.kalman import kalman_filter, smooth  # numba takes a quarter of a second

    where = model.plant.port(port)
    if not where.in_equations:
        raise ValueError(
            f"port {port} is of kind {where.kind}: a missing effort can only be estimated at an effort port, "
            "a missing flow at a flow port"
        )
    whole, (first, end) = record, max(record.joined, key=lambda part: part[1] - part[0])
    record = whole.part(first, end) if end - first < whole.n else whole
    walking = model.plus(replace(WALK, kind=where.kind), port)
    p = walking.values(_known(walking, {**values, f"{port}.{WALK.id}.g": 1.0}))
    about = np.zeros((record.n, len(walking.states)))
    about[:, :-1] = filled_states(model, model.values(_known(model, values)), record)
    linear = _Linearised(walking, record, p)
    scales = np.array([s.scale for s in walking.states])
    noise = noise_level(record) ** 2
    per_sample = where.effort_scale * np.sqrt(record.dt / where.time_scale)
    grid = list(range(len(INTENSITIES)))
    for _ in range(PASSES):
        a, b, c, d = linear.about(about)

        def likelihood(k: int) -> float:
            walk = (INTENSITIES[k] * per_sample) ** 2
            return float(kalman_filter(a, b, c, d, record.outputs, noise, scales, walk)[0])  # noqa: B023

        best = max(grid, key=likelihood)
        grid = [k for k in range(len(INTENSITIES)) if abs(k - best) <= NEAR]
        walk = (INTENSITIES[best] * per_sample) ** 2
        _, mean, cov, predicted, spread = kalman_filter(a, b, c, d, record.outputs, noise, scales, walk)
        before, (about, covariance) = about, smooth(a, mean, cov, predicted, spread)
        if not (np.isfinite(about).all() and np.isfinite(covariance).all()):
            raise ArithmeticError(
                "the smoother diverges: the model cannot be linearised from sample to sample"
            )
        moved = np.abs(about[:, -1] - before[:, -1])
        if np.median(moved) < STILL * np.sqrt(max(0.0, np.median(covariance))):  # by rounding below zero
            break
    found = _result(walking, record, port, p, about, covariance, float(INTENSITIES[best]))
    rests = _rests(found, walking, where, p)
    shown = record.counts & ~rests
    if not shown.any():
        raise ValueError("the machine rests on the whole record: dry friction hides what is missing")
    found = replace(found, rests=bool(rests.any()))
    return found if shown.all() and not whole.masked else _shown(found, np.flatnonzero(shown), first)


def _rests(found: MissingEffort, model: Model, port: Port, p: Array) -> NDArray[np.bool_]:
    if port.kind != "effort":
        return np.zeros(len(found.time), dtype=bool)
    return held_at_rest(model, port, p, found.time, found.motion["velocity"][0])


def _shown(found: MissingEffort, kept: NDArray[np.int64], first: int) -> MissingEffort:
    """``found`` at the samples ``kept``; it begins at sample ``first`` of the record."""
    arrays = {name: getattr(found, name)[kept] for name in ("time", "effort", "std")}
    motion = {name: (values[kept], unit) for name, (values, unit) in found.motion.items()}
    return replace(found, **arrays, motion=motion, rows=first + kept)


def _known(model: Model, values: Mapping[str, float]) -> dict[str, float]:
    """Those of ``values`` that ``model`` has."""
    names = {q.name for q in model.parameters}
    return {name: value for name, value in values.items() if name in names}


def _result(
    model: Model, record: Record, port: str, p: Array, states: Array, covariance: Array, intensity: float
) -> MissingEffort:
    where = model.plant.port(port)
    index = [q.name for q in model.equation_ports].index(port)
    n = record.n
    motion = np.asarray(
        model.motions.map(n)(record.time[None, :], states.T, record.inputs.T, np.tile(p[:, None], n))
    )
    position, velocity = motion[index].reshape(n, 2).T
    return MissingEffort(
        record=record.name,
        provenance=record.provenance,
        port=port,
        kind=where.kind,
        unit=where.effort_unit,
        time=record.time,
        effort=states[:, -1],
        std=np.sqrt(np.maximum(covariance, 0.0)),
        motion=_motion(where, record.time, position, velocity),
        intensity=intensity,
    )


def _motion(port: Port, time: Array, position: Array, velocity: Array) -> dict[str, tuple[Array, str]]:
    """What an effort or a flow at ``port`` could depend on: values (n,) and unit, by name."""
    unit = port.position_unit
    if port.kind == "flow":
        return {"level": (position, unit), "net flow": (velocity, f"{unit}/s")}
    return {
        "velocity": (velocity, f"{unit}/s"),
        "position": (position, unit),
        "acceleration": (np.gradient(velocity, time), f"{unit}/s²"),
        SINCE_REVERSAL: (_since_reversal(position, velocity), unit),
    }


def _since_reversal(position: Array, velocity: Array) -> Array:
    """Travel since the velocity last changed sign, (n,)."""
    turned = np.flatnonzero(np.diff(np.sign(velocity)) != 0) + 1
    last = np.zeros(len(velocity), dtype=int)
    last[turned] = turned
    return np.abs(position - position[np.maximum.accumulate(last)])


@dataclass(frozen=True)
class _Linearised:
    """One sample's map and output, linearised about given states."""

    model: Model
    record: Record
    p: Array

    def about(self, states: Array) -> tuple[Array, Array, Array, Array]:
        """``x+ = A x + b``, ``y = C x + d`` at every sample: (n, m, m), (n, m), (n, n_y, m), (n, n_y)."""
        record, model = self.record, self.model
        substeps = substeps_for(model, self.p, [record])
        held = all_held(record)
        step = sample_step("rk4", model, record.dt, substeps, held)
        t, x = ca.SX.sym("t"), ca.SX.sym("x", len(model.states))
        stages = ca.SX.sym("U", step.size1_in(2))
        u, q = ca.SX.sym("u", len(model.inputs)), ca.SX.sym("p", len(self.p))
        following, output = step(t, x, stages, q), model.h(t, x, u, q)
        parts = (following, ca.jacobian(following, x), output, ca.jacobian(output, x))
        one = ca.Function("linear", [t, x, stages, u, q], [ca.densify(v) for v in parts])
        n, m, n_y = record.n, len(model.states), len(model.outputs)
        data = (record.time[None, :], states.T, stage_inputs(record, substeps).T, record.inputs.T)
        x_next, a, y, c = (np.asarray(v) for v in one.map(n)(*data, np.tile(self.p[:, None], n)))
        a = a.reshape(m, n, m).swapaxes(0, 1)
        c = c.reshape(n_y, n, m).swapaxes(0, 1)
        b = x_next.T - np.einsum("nij,nj->ni", a, states)
        d = y.T - np.einsum("nij,nj->ni", c, states)
        if record.partly:  # an output that depends on no state and is as measured moves nothing
            unseen = ~record.cells
            c[unseen], d[unseen] = 0.0, record.outputs[unseen]
        return (
            np.ascontiguousarray(a),
            np.ascontiguousarray(b),
            np.ascontiguousarray(c),
            np.ascontiguousarray(d),
        )
