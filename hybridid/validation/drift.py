"""Which outputs drift in a free run, whatever the fit, since the model integrates.

``x' = A x`` forgets an error with its modes. One with ``|λ| T < 1`` neither decays nor swings back within a
record of T seconds: it integrates, as the position of a ball on a beam does, on which no force acts that
depends on where it is. A small error of the initial state, of an offset or of a measured input then stays,
or adds up, to the end. So a bad free run tells little of such a model, and predictions over horizons are
what to judge by.

Source: Ljung (1999), System Identification, 2nd edition, chapter 3: simulation and prediction.
"""

from __future__ import annotations

from collections.abc import Sequence

import casadi as ca
import numpy as np
from numpy.typing import NDArray
from scipy.linalg import LinAlgError, schur

from hybridid.model import Model
from hybridid.records.record import Record
from hybridid.simulation.unobserved import filled_states

Array = NDArray[np.float64]
PROBES = 50
"""Samples of each record at which the model is linearised; an output drifts if it does at most of them."""
SEEN = 0.1
"""Share of an output's slope along all states that lies along those that integrate, if it drifts."""


def outputs_that_drift(model: Model, p: Array, records: Sequence[Record]) -> list[bool]:
    """Whether each output follows states that integrate, at ``p`` (n_p,)."""
    scale = np.array([one.scale for one in model.states])
    seen = model.kept("outputs by state", lambda: _by_state(model.h))
    votes = []
    for record in records:
        path, seconds = filled_states(model, p, record), record.time[-1] - record.time[0]
        for k in np.unique(np.linspace(0, record.n - 1, PROBES).astype(int)):
            at = (record.time[k], path[k], record.inputs[k], p)
            motion, output = np.asarray(model.by_state(*at)), np.asarray(seen(*at))
            votes.append(_drifts(motion * scale / scale[:, None], output * scale, float(seconds)))
    return [bool(one) for one in np.mean(votes, axis=0) > 0.5]


def _by_state(h: ca.Function) -> ca.Function:
    given = h.sx_in()
    return ca.Function("C", given, [ca.densify(ca.jacobian(h(*given), given[1]))])


def _drifts(motion: Array, output: Array, seconds: float) -> NDArray[np.bool_]:
    """Whether each row of ``output`` (n_y, n_x) sees the subspace of ``motion`` (n_x, n_x) that integrates
    over so many ``seconds``. It is an invariant one: a double integrator has one eigenvector only."""
    none = np.zeros(len(output), dtype=bool)
    if not (np.isfinite(motion).all() and np.isfinite(output).all()):
        return none
    try:
        _, basis, count = schur(motion, output="complex", sort=lambda mode: abs(mode) * seconds < 1.0)
    except LinAlgError:
        return none
    along, whole = (np.linalg.norm(part, axis=1) for part in (output @ basis[:, :count], output))
    return np.asarray((whole > 0) & (along > SEEN * whole))
