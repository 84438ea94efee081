"""Whether the records show the form that an effect claims: that it repeats, or that it has an edge.

A contact does nothing up to an edge, and presses beyond it. Where a record never leaves it, it is a spring
about a centre, or a leak: another effect, with an edge that nothing shows. A stop pushes back. Where its
spring makes next to nothing of what it does, and its damper all, it is a friction that begins at a place.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from hybridid.trace.candidates import Candidate
from hybridid.trace.horizons.split import Split
from hybridid.trace.ports.path import Path
from hybridid.trace.refits.refitted import Refit
from hybridid.trace.starts.periodic import not_repeated

NOTHING = 1e-3
"""Of a contact's largest effort: what it may do where it does nothing, its edge being round."""
LEFT = 0.01
"""Share of the fitted samples in which a contact must do nothing."""
PUSHES = 0.01
"""Share of the mean square of a contact's effort that its spring must make."""


def not_shown(candidate: Candidate, found: Refit, split: Split) -> str:
    """Why the records do not show the form of the effect; empty if they do."""
    contact = any(p.hard for p in candidate.effect.parameters)
    return not_repeated(candidate, found, split) or (_no_contact(candidate, found, split) if contact else "")


def _no_contact(candidate: Candidate, found: Refit, split: Split) -> str:
    path, place = Path.of(found, split, split.fitted), (candidate.name, candidate.ports[0])
    effort = path.effort_of(*place)
    if np.mean(np.abs(effort) <= NOTHING * np.abs(effort).max()) < LEFT:
        return "it acts in every fitted sample: the records do not show its edge"
    dampers = {f"{candidate.name}.{p.name}": 0.0 for p in candidate.effect.parameters if p.minor}
    spring = replace(path, p=found.model.values({**found.values, **dampers})).effort_of(*place)
    if np.mean(spring**2) < PUSHES * np.mean(effort**2):
        return "it damps and does not push back: the records show no stop"
    return ""
