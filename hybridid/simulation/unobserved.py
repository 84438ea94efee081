"""States that no output shows, guessed from a free run of the model."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from hybridid.model import Model
from hybridid.records.record import Record
from hybridid.simulation.initial import measured_states, observed
from hybridid.simulation.shooter import Shooter
from hybridid.simulation.windows import cut

Array = NDArray[np.float64]


def filled_states(model: Model, p: Array, record: Record) -> Array:
    """States from the record where an output shows them, else from ``free_run_states``; (n, n_x)."""
    measured = measured_states(model, record)
    shown = np.array(observed(model))
    return measured if shown.all() else np.where(shown, measured, free_run_states(model, p, record))


def free_run_states(model: Model, p: Array, record: Record) -> Array:
    """States (n, n_x) of a run over the record's inputs from what its first samples say.

    What no output shows begins at zero, at rest. The integrator is the implicit one, stable whatever
    ``p`` (n_p,) is; a state that leaves the range of numbers counts as zero from there on.
    """
    windows = cut([record], None, 1)
    start = measured_states(model, record)[:1]
    states = Shooter(model, windows, integrator="rodas3")(start, p).states[0, : record.n]
    return np.where(np.isfinite(states).all(axis=1, keepdims=True), states, 0.0)
