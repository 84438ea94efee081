"""Where dry friction holds a machine at rest.

There the friction is whatever balances the other efforts, up to its level. So a record does not show what a
model with dry friction lacks. (A sign(v) that is smoothed is zero at rest. What balances would then be taken
for a missing effort.)
"""

from __future__ import annotations

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from hybridid.declarations import Port
from hybridid.model import Model

Array = NDArray[np.float64]
SLOW = 0.01
"""Share of the RMS velocity below which a machine may rest."""
FOR = 0.1
"""Of the port's time scale: slow for longer, it rests. A reversal takes less."""


def held_at_rest(model: Model, port: Port, p: Array, time: Array, velocity: Array) -> NDArray[np.bool_]:
    """At which samples (n,) dry friction of ``model`` holds the effort port, at the parameters ``p`` (n_p,);
    ``velocity`` (n,) is that of the port at ``time`` (n,)."""
    rests = np.zeros(len(time), dtype=bool)
    if not _is_dry(model, port):
        return rests
    width = p[_names(model).index(f"{port.name}.epsilon")]
    slow = np.abs(velocity) < min(width, SLOW * float(np.sqrt(np.mean(velocity**2))))
    edges = np.flatnonzero(np.diff(slow.astype(int), prepend=0, append=0))
    for begin, end in edges.reshape(-1, 2):
        rests[begin:end] = time[end - 1] - time[begin] > FOR * port.time_scale
    return rests


def _is_dry(model: Model, port: Port) -> bool:
    """Whether an effort of ``model`` at the port contains a sign(v)."""
    rows = [k for k, (_, where) in enumerate(model.effort_places) if where == port.name]
    if not rows:
        return False
    t, x, u, p = model.efforts.sx_in()
    width = p[_names(model).index(f"{port.name}.epsilon")]
    return any(ca.which_depends(model.efforts(t, x, u, p)[rows], width, 1, True))


def _names(model: Model) -> list[str]:
    return [q.name for q in model.parameters]
