"""How many integration steps a sample needs to be stable and accurate."""

from __future__ import annotations

from collections.abc import Sequence

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from hybridid.model import Model
from hybridid.records.record import Record
from hybridid.simulation.initial import measured_states

Array = NDArray[np.float64]
COMFORTABLE = 1.0
"""|eigenvalue| times step that RK4 integrates with an error below 1 %; its limit is 2.78."""
PROBES = 200
MOST = 50
"""A model stiffer than this many steps a sample wants another integrator."""


def stiffness(model: Model, p: Array, records: Sequence[Record]) -> float:
    """Largest |eigenvalue| of df/dx in 1/s, over the record and at rest."""
    x = ca.SX.sym("x", len(model.states))
    t, u = ca.SX.sym("t"), ca.SX.sym("u", len(model.inputs))
    q = ca.SX.sym("p", len(model.parameters))
    jacobian = ca.Function("A", [t, x, u, q], [ca.jacobian(model.f(t, x, u, q), x)])
    largest = 0.0
    for record in records:
        states = measured_states(model, record)
        for k in np.unique(np.linspace(0, record.n - 1, PROBES).astype(int)):
            for state in (states[k], np.zeros(states.shape[1])):
                matrix = np.asarray(jacobian(record.time[k], state, record.inputs[k], p))
                if np.isfinite(matrix).all():
                    largest = max(largest, float(np.abs(np.linalg.eigvals(matrix)).max()))
    return largest


def substeps_for(model: Model, p: Array, records: Sequence[Record], margin: float = 1.0) -> int:
    """Steps a sample that keep ``|eigenvalue| h`` below ``COMFORTABLE / margin``.

    Raises:
        ValueError: if more than ``MOST`` steps would be needed.
    """
    rate = stiffness(model, p, records)
    steps = max(1, int(np.ceil(rate * records[0].dt * margin / COMFORTABLE)))
    if steps > MOST:
        raise ValueError(
            f"the model is too stiff for RK4: {rate:.3g} 1/s would need {steps} steps a sample "
            f"(at most {MOST}); raise the port's epsilon or lower a stiffness"
        )
    return steps
