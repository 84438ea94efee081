"""Which outputs drift in a free run, whatever the fit, since the model integrates or is unstable.

``x' = A x`` forgets an error with its modes. One with ``|λ| T < 1`` neither decays nor swings back within a
record of T seconds: it integrates, as the position of a ball on a beam does, on which no force acts that
depends on where it is. A small error of the initial state, of an offset or of a measured input then stays,
or adds up, to the end. One with ``Re λ T > 1`` lets it grow by more than e: a pendulum that a loop holds
upright, simulated without the loop, falls. So a bad free run tells little of such a model, and predictions
over horizons are what to judge by.

Source: Ljung (1999), System Identification, 2nd edition, chapter 3: simulation and prediction.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import LinAlgError, schur

from hybridid.model import Model
from hybridid.records.record import Record
from hybridid.simulation.linearised import Linearised, linearised

Array = NDArray[np.float64]
SEEN = 0.1
"""Share of an output's slope along all states that lies along those that integrate, if it drifts."""


def outputs_that_drift(model: Model, p: Array, records: Sequence[Record]) -> list[bool]:
    """Whether each output follows states that integrate or are unstable, at ``p`` (n_p,) and most samples."""
    votes = [_drifts(at) for at in linearised(model, p, records)]
    return [bool(one) for one in np.mean(votes, axis=0) > 0.5]


def growth(model: Model, p: Array, records: Sequence[Record]) -> float:
    """The rate [1/s] at which an error grows in a free run at ``p`` (n_p,): the median of the largest real
    part of the modes; 0 where it grows by less than e within a record at half of the samples or more."""
    rates = []
    for at in linearised(model, p, records):
        rate = float(at.modes.real.max(initial=0.0))
        rates.append(rate if rate * at.seconds > 1.0 else 0.0)
    return float(np.median(rates))


def _drifts(at: Linearised) -> NDArray[np.bool_]:
    """Whether each output sees the subspace of the motion that integrates or grows over the record. It is
    invariant: a double integrator has one eigenvector only."""
    none = np.zeros(len(at.outputs), dtype=bool)
    if not at.finite:
        return none
    try:
        _, basis, count = schur(at.motion, output="complex", sort=lambda mode: _stays(mode, at.seconds))
    except LinAlgError:
        return none
    along, whole = (np.linalg.norm(part, axis=1) for part in (at.outputs @ basis[:, :count], at.outputs))
    return np.asarray((whole > 0) & (along > SEEN * whole))


def _stays(mode: complex, seconds: float) -> bool:
    """Whether an error of a mode [1/s] stays, or grows by more than e, over so many seconds."""
    return abs(mode) * seconds < 1.0 or mode.real * seconds > 1.0
