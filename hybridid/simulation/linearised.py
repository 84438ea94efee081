"""A model linearised along its records: ``x' = A x``, ``y = C x`` at some samples of each.

Its modes are the eigenvalues of A. They do not depend on the units of the states; the states are scaled, so
that directions among them can be compared.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from hybridid.model import Model
from hybridid.records.record import Record
from hybridid.simulation.unobserved import filled_states

Array = NDArray[np.float64]
CREEPING = 5.0
"""Times epsilon up to which the slope of tanh(v/epsilon) may be felt: there it is 2e-4 of that at rest."""
PROBES = 50
"""Samples of each record at which a model is linearised."""


@dataclass(frozen=True)
class Linearised:
    """A model at one sample of a record of so many ``seconds``: slopes of the ``motion`` (n_x, n_x) [1/s] and
    of the ``outputs`` (n_y, n_x) by the scaled states. ``creeps``: a port is so slow that the smoothing of
    sign(v) makes its slopes."""

    motion: Array
    outputs: Array
    seconds: float
    creeps: bool = False

    @property
    def finite(self) -> bool:
        """Whether all slopes are finite."""
        return bool(np.isfinite(self.motion).all() and np.isfinite(self.outputs).all())

    @property
    def modes(self) -> NDArray[np.complex128]:
        """The eigenvalues [1/s] of the motion, (n_x,); none where a slope is not finite."""
        return np.linalg.eigvals(self.motion).astype(complex) if self.finite else np.empty(0, complex)


def linearised(model: Model, p: Array, records: Sequence[Record]) -> Iterator[Linearised]:
    """``model`` at ``p`` (n_p,), linearised at up to ``PROBES`` samples of each record."""
    scale = np.array([one.scale for one in model.states])
    seen = model.kept("outputs by state", lambda: _by_state(model.h))
    known = dict(zip([q.name for q in model.parameters], p, strict=True))
    widths = np.array([known.get(f"{port.name}.epsilon", 0.0) for port in model.equation_ports])
    for record in records:
        path, seconds = filled_states(model, p, record), float(record.time[-1] - record.time[0])
        for k in np.unique(np.linspace(0, record.n - 1, PROBES).astype(int)):
            at = (record.time[k], path[k], record.inputs[k], p)
            motion, outputs = np.asarray(model.by_state(*at)), np.asarray(seen(*at))
            creeps = widths.any() and _is_below(CREEPING * widths, model.motions(*at))
            yield Linearised(motion * scale / scale[:, None], outputs * scale, seconds, bool(creeps))


def _is_below(limits: Array, motions: ca.DM) -> bool:
    """Whether a port is slower than its limit, of ``limits`` (n_ports,), by its ``motions`` (n_ports, 2)."""
    return bool((np.abs(np.asarray(motions)[:, 1]) < limits).any())


def _by_state(h: ca.Function) -> ca.Function:
    given = h.sx_in()
    return ca.Function("C", given, [ca.densify(ca.jacobian(h(*given), given[1]))])
