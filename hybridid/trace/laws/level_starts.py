"""Where the refit of a law with a level starts: as near as possible to an amplitude that was freed.

A fit with the amplitude of a law free over another variable (``hybridid.trace.learned.varying``) gives the
effort k f(x) A(y) along the path. At each point of a grid of the level's shape parameters, a linear
regression of that effort on k f(x) g(y) gives the amplitude, and for a raised level 1 + h g(y) the share h as
well. The point that comes nearest is the start. It only chooses where a refit begins; the refit decides.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from hybridid.effects.composed import Bounded
from hybridid.effects.levels import Level
from hybridid.effects.over import MEMORIES
from hybridid.effects.shapes import Shape
from hybridid.trace.candidates import Candidate
from hybridid.trace.horizons.split import Split
from hybridid.trace.laws.law_starts import bounded, grid
from hybridid.trace.learned.varying import Varied
from hybridid.trace.ports.path import Path

Array = NDArray[np.float64]
MOST_SHARE = 100.0
"""By which a level may rise, times what it rises from."""


@dataclass(frozen=True)
class FreedPath:
    """Along the path of a freed amplitude: the variable y (n,), the law's effort with the amplitude as a
    constant (n,), and as it was freed (n,)."""

    y: Array
    constant: Array
    freed: Array


def freed_path(law: Candidate, varied: Varied, split: Split) -> FreedPath:
    """The path of ``varied``, in which the amplitude of ``law`` was freed, through the fitted horizons."""
    found = varied.refit
    assert found is not None
    path = Path.of(found, split, split.fitted)
    names = [state.name for state in found.model.states]
    memory = MEMORIES.get(varied.over.variable)
    y = path.seen(law.port, varied.over)
    if memory is not None:
        y = path.states[:, names.index(f"{law.name}.{memory.state.name}")]
    shares = {f"{law.name}.a{j}" for j in range(len(found.values))}
    constant = {name: 0.0 if name in shares else value for name, value in found.values.items()}
    at_rest = replace(path, p=found.model.values(constant))
    return FreedPath(y, at_rest.effort_of(law.name, law.port), path.effort_of(law.name, law.port))


def level_starts(law: Candidate, level: Level, varied: Varied, split: Split) -> dict[str, Bounded]:
    """Guess and bounds of each parameter of ``law`` times ``level``, in the likeness of ``varied``."""
    assert varied.refit is not None
    along, values = freed_path(law, varied, split), varied.refit.values
    point, amplitude = _nearest(level.shape, along)
    begun: dict[str, Bounded] = {}
    for p in law.effect.parameters:
        value = values[f"{law.name}.{p.name}"]
        begun[p.name] = Bounded(value * amplitude if p.nests else value, p.lower, p.upper)
    for name, value in point.items():
        role = level.shape.roles[name]
        share = Bounded(value, -MOST_SHARE, MOST_SHARE)
        begun[name] = share if role == "share" else bounded(role, value, along.y)
    memory = level.memory
    if memory is not None:
        name = f"{law.name}.{memory.name}"
        declared = next(p for p in varied.refit.model.parameters if p.name == name)
        begun[memory.name] = Bounded(values[name], declared.lower, declared.upper)
    return begun


def _nearest(shape: Shape, along: FreedPath) -> tuple[dict[str, float], float]:
    """The shape parameters, and the amplitude over the constant one, nearest to the freed effort."""
    raised = "h_2" in shape.roles
    nearest, amplitude, least = dict[str, float](), 1.0, np.inf
    for point in grid(shape, along.y):
        columns = [along.constant * shape.values(along.y, {**point, "h_2": 1.0})]
        if raised:
            columns = [along.constant, columns[0] - along.constant]
        if not np.isfinite(columns).all():
            continue
        parts, *_ = np.linalg.lstsq(np.column_stack(columns), along.freed, rcond=None)
        error = float(np.sum((along.freed - np.column_stack(columns) @ parts) ** 2))
        if error >= least:
            continue
        least, amplitude = error, float(parts[0])
        share = {"h_2": _share(*parts)} if raised else {}
        nearest = {**point, **share}
    return nearest, amplitude


def _share(constant: float, rising: float) -> float:
    """The share by which a level rises from its ``constant`` part, well within its bounds."""
    return float(np.clip(rising / (constant or np.inf), -MOST_SHARE / 2, MOST_SHARE / 2))
