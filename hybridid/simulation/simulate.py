"""Simulate a model over a record from one initial state."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hybridid.model import Model
from hybridid.records.record import Record
from hybridid.simulation.initial import measured_states
from hybridid.simulation.matching import check_records
from hybridid.simulation.shooter import Shooter, Shot
from hybridid.simulation.stability import in_enough_steps, stays_near, substeps_to_predict
from hybridid.simulation.windows import cut

Array = NDArray[np.float64]


class Diverged(ValueError):
    """Raised if a simulation is no longer finite; the message says at what time."""


@dataclass(frozen=True)
class Trajectory:
    """A simulated run: ``time`` (n,) s, ``states`` (n, n_x), ``outputs`` (n, n_y)."""

    time: Array
    states: Array
    outputs: Array
    state_names: tuple[str, ...]


def simulate(
    model: Model,
    values: Mapping[str, float],
    record: Record,
    initial_state: Array | None = None,
    substeps: int | None = None,
    integrator: str = "rk4",
) -> Trajectory:
    """Free-run ``model`` over the inputs of ``record``.

    Args:
        values: parameter values by qualified name; guesses serve for the others.
        initial_state: (n_x,); by default estimated from the record's first samples.
        substeps: integration steps a sample; by default as many as the integrator needs.

    Raises:
        Diverged: if the simulation does not stay finite.
        ValueError: if the record lacks a signal of the model, or a value names no parameter.
    """
    check_records(model, [record])
    p = model.values(values)
    x0 = measured_states(model, record)[0] if initial_state is None else np.asarray(initial_state, float)

    def shot_in(steps: int) -> Shot:
        return Shooter(model, cut([record.unmasked()], None, steps), integrator=integrator)(x0[None, :], p)

    if substeps:
        shot = shot_in(substeps)
    else:
        steps = substeps_to_predict(model, p, [record], integrator=integrator)
        shot = in_enough_steps(shot_in, lambda found: stays_near(found.outputs[0, : record.n], record), steps)
    outputs, states = shot.outputs[0, : record.n], shot.states[0, : record.n]
    if not np.isfinite(outputs).all():
        first = int(np.argmin(np.isfinite(outputs).all(axis=1)))
        raise Diverged(f"simulation of record {record.name} diverged at t = {record.time[first]:.4g} s")
    return Trajectory(record.time, states, outputs, tuple(s.name for s in model.states))
