"""Whether the records show the form that an effect claims: that it repeats, or that it has an edge.

A contact does nothing up to an edge, and presses beyond it. Where a record never leaves it, it is a spring
about a centre, or a leak: another effect, with an edge that nothing shows.
"""

from __future__ import annotations

import numpy as np

from hybridid.trace.candidates import Candidate
from hybridid.trace.path import Path
from hybridid.trace.periodic import not_repeated
from hybridid.trace.refitted import Refit
from hybridid.trace.split import Split

NOTHING = 1e-3
"""Of a contact's largest effort: what it may do where it does nothing, its edge being round."""
LEFT = 0.01
"""Share of the fitted samples in which a contact must do nothing."""


def not_shown(candidate: Candidate, found: Refit, split: Split) -> str:
    """Why the records do not show the form of the effect; empty if they do."""
    return not_repeated(candidate, found, split) or _never_left(candidate, found, split)


def _never_left(candidate: Candidate, found: Refit, split: Split) -> str:
    if not any(p.hard for p in candidate.effect.parameters):
        return ""
    effort = np.abs(Path.of(found, split, split.fitted).effort_of(candidate.name, candidate.ports[0]))
    if np.mean(effort <= NOTHING * effort.max()) >= LEFT:
        return ""
    return "it acts in every fitted sample: the records do not show its edge"
