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

from collections.abc import Iterator, Sequence

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
    """Whether each output follows states that integrate or are unstable, at ``p`` (n_p,)."""
    votes = [_drifts(*at) for at in _linearised(model, p, records)]
    return [bool(one) for one in np.mean(votes, axis=0) > 0.5]


def growth(model: Model, p: Array, records: Sequence[Record]) -> float:
    """The rate [1/s] at which an error grows in a free run at ``p`` (n_p,): the median of the largest real
    part of the modes; 0 where it grows by less than e within a record at half of the samples or more."""
    rates = []
    for motion, _, seconds in _linearised(model, p, records):
        rate = float(np.linalg.eigvals(motion).real.max()) if np.isfinite(motion).all() else 0.0
        rates.append(rate if rate * seconds > 1.0 else 0.0)
    return float(np.median(rates))


def _linearised(model: Model, p: Array, records: Sequence[Record]) -> Iterator[tuple[Array, Array, float]]:
    """Slopes of the motion (n_x, n_x) and of the outputs (n_y, n_x) by the scaled states at some samples of
    each record, and its seconds."""
    scale = np.array([one.scale for one in model.states])
    seen = model.kept("outputs by state", lambda: _by_state(model.h))
    for record in records:
        path, seconds = filled_states(model, p, record), record.time[-1] - record.time[0]
        for k in np.unique(np.linspace(0, record.n - 1, PROBES).astype(int)):
            at = (record.time[k], path[k], record.inputs[k], p)
            motion, output = np.asarray(model.by_state(*at)), np.asarray(seen(*at))
            yield motion * scale / scale[:, None], output * scale, float(seconds)


def _by_state(h: ca.Function) -> ca.Function:
    given = h.sx_in()
    return ca.Function("C", given, [ca.densify(ca.jacobian(h(*given), given[1]))])


def _drifts(motion: Array, output: Array, seconds: float) -> NDArray[np.bool_]:
    """Whether each row of ``output`` (n_y, n_x) sees the subspace of ``motion`` (n_x, n_x) that integrates
    or grows over so many ``seconds``. It is invariant: a double integrator has one eigenvector only."""
    none = np.zeros(len(output), dtype=bool)
    if not (np.isfinite(motion).all() and np.isfinite(output).all()):
        return none
    try:
        _, basis, count = schur(motion, output="complex", sort=lambda mode: _stays(mode, seconds))
    except LinAlgError:
        return none
    along, whole = (np.linalg.norm(part, axis=1) for part in (output @ basis[:, :count], output))
    return np.asarray((whole > 0) & (along > SEEN * whole))


def _stays(mode: complex, seconds: float) -> bool:
    """Whether an error of a mode [1/s] stays, or grows by more than e, over so many seconds."""
    return abs(mode) * seconds < 1.0 or mode.real * seconds > 1.0
