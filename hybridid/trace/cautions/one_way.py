"""Whether the horizons that judge move a port in a direction that no fitted one does.

A friction that differs by direction acts, in records of one direction, as a part of the common friction: no
parameter tells the two apart. Records of the other direction then differ from what was fitted, and an effect
that has nothing to do with the direction may happen to mend that. So there a verdict is one of extrapolation.
"""

from __future__ import annotations

from hybridid.naming import listed
from hybridid.trace.context import Context
from hybridid.trace.ports.path import Path
from hybridid.trace.refits.refitted import Refit

HARDLY, MUCH = 0.01, 0.1
"""Shares of the way in one direction: so little of what was fitted, and so much of what judges."""


def judged_the_other_way(declared: Refit, context: Context) -> str:
    """Which ports of the fitted ``declared`` model are judged in a direction that was hardly fitted, in
    words; empty if none is."""
    split = context.split
    ours, theirs = (Path.of(declared, split, part) for part in (split.fitted, split.held_out))
    ports = [port.name for port in declared.model.equation_ports if port.kind == "effort"]
    found = [port for port in ports if _leaves(_ways(ours, port), _ways(theirs, port))]
    if not found:
        return ""
    return (
        f" Beware: what judges moves {listed(found)} in a direction that was hardly fitted, so the verdict "
        "is one of extrapolation. What differs by direction does not show in one direction: fit a record of "
        "each (fit.records, trace.records)."
    )


def _ways(path: Path, port: str) -> tuple[float, float]:
    """The shares of the way that are travelled forwards and backwards."""
    velocity = path.motion(port, "velocity")
    forwards, backwards = (float(abs(velocity[part]).sum()) for part in (velocity > 0, velocity < 0))
    whole = forwards + backwards or 1.0
    return forwards / whole, backwards / whole


def _leaves(fitted: tuple[float, float], judged: tuple[float, float]) -> bool:
    return any(ours < HARDLY and theirs > MUCH for ours, theirs in zip(fitted, judged, strict=True))
