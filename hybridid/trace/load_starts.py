"""Starts of a load behind a spring or a play: half of the inertia that the model without it has found.

Slow motion shows the sum of both inertias alone, and the model without the load has found that as the
machine's. With no load to begin with, a descent goes along a valley in which the sum stays: it is long, and
may end at a small load. So the load also begins in the midst of it, with half of the sum.

The inertia at a port is 1 over the change of its acceleration by an effort there. Of the plant's parameters,
the one that makes up most of it gives the half away.

Source: Spong (1987), ASME J. Dyn. Syst. Meas. Control 109(4), 310-319 (a machine and its load as two bodies).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from hybridid.model import Model
from hybridid.trace.candidates import Candidate, each_once
from hybridid.trace.path import Path
from hybridid.trace.refit import Refit
from hybridid.trace.split import Split
from hybridid.validation.port_efforts import PROBE

Array = NDArray[np.float64]
PROBES = 50
"""Samples at which the inertia is computed; their median counts."""
NUDGE = 1e-4
"""Share of its value by which a parameter is changed, to see how much of the inertia it makes up."""
MOST = 0.6
"""Share of the inertia that a parameter makes up at least, to give half of it away."""


def with_half_the_inertia(
    candidate: Candidate, starts: Sequence[dict[str, float]], base: Refit, split: Split
) -> list[dict[str, float]]:
    """``starts`` with half of the inertia at the port as that of the load; none where the effect has no load,
    or no parameter of the plant is that inertia."""
    loads = [p.name for p in candidate.effect.parameters if p.sought == "load"]
    given = _largest_part(candidate.port, base, split) if loads and starts else None
    if given is None:
        return []
    name, left, half = given
    return each_once([{**start, name: left, f"{candidate.name}.{loads[0]}": half} for start in starts])


def _largest_part(port: str, base: Refit, split: Split) -> tuple[str, float, float] | None:
    """The parameter of the plant that makes up most of the inertia at ``port``, its value without half of the
    inertia, and this half; None if none makes up enough, or that value is below its bound."""
    path = Path.of(base, split, split.fitted[:1])
    inertia = _inertia(base.model, port, path)
    whole = inertia(base.values)
    if not (np.isfinite(whole) and whole > 0):
        return None
    parts = []
    own = {p.name for p in base.model.plant.parameters}
    for p in base.model.free:
        value = base.values[p.name]
        if p.name in own and value > 0:
            more = inertia({**base.values, p.name: (1 + NUDGE) * value})
            parts.append(((more - whole) / (NUDGE * whole), value, p))
    if not parts:
        return None
    share, value, p = max(parts, key=lambda part: part[0])
    left = value * (1 - 0.5 / max(share, MOST))
    return (p.name, left, whole / 2) if share >= MOST and left >= p.lower else None


def _inertia(model: Model, port: str, path: Path) -> Callable[[Mapping[str, float]], float]:
    """The inertia at ``port`` along ``path``, as a function of the model's parameters by name: 1 over what
    an effort there takes from the acceleration; nan where the port is not accelerated by it."""
    probed = model.plus(PROBE, port)
    t, x, u, p = probed.f.sx_in()
    place = [one.name for one in model.equation_ports].index(port)
    velocity = probed.motions(t, x, u, p)[place, 1]
    acceleration = ca.jtimes(velocity, x, probed.f(t, x, u, p))
    effort = p[[one.name for one in probed.parameters].index(f"{port}.{PROBE.id}.unit")]
    by_effort = ca.Function("by_effort", [t, x, u, p], [ca.jacobian(acceleration, effort)])
    chosen = np.unique(np.linspace(0, len(path.time) - 1, PROBES).astype(int))

    def at(values: Mapping[str, float]) -> float:
        q = probed.values(values)
        found = [float(by_effort(path.time[k], path.states[k], path.inputs[k], q)) for k in chosen]
        taken = -float(np.median(found))
        return 1.0 / taken if taken > 0 else np.nan

    return at
