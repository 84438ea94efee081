"""Unobserved states, estimated from a free run of the model."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from hybridid.model import Model
from hybridid.records.record import Record
from hybridid.simulation.initial import measured_states, observed
from hybridid.simulation.shooter import Shooter
from hybridid.simulation.windows import cut

Array = NDArray[np.float64]


def filled_states(model: Model, p: Array, record: Record, substeps: int = 1) -> Array:
    """Observed states from the record, the others from ``free_run_states``; (n, n_x)."""
    measured = measured_states(model, record)
    shown = np.array(observed(model))
    return measured if shown.all() else np.where(shown, measured, free_run_states(model, p, record, substeps))


def free_run_states(model: Model, p: Array, record: Record, substeps: int = 1) -> Array:
    """States (n, n_x) of a simulation over the record's inputs, from the state at its first samples.

    Unobserved states begin at zero. The integrator is the implicit one, which is stable for any ``p`` (n_p,),
    and accurate as its ``substeps`` a sample are short. A state that is no longer finite counts as zero from
    there on.
    """
    windows = cut([record.unmasked()], None, substeps)
    start = measured_states(model, record)[:1]
    states = Shooter(model, windows, integrator="rodas3")(start, p).states[0, : record.n]
    return np.where(np.isfinite(states).all(axis=1, keepdims=True), states, 0.0)
