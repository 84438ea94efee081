"""Laws over the recent load of a machine that was loaded before its record began.

A variable with memory begins at nothing with each record, as every inner state does. Where the machine
stands under load, its contact has long settled to that. What the lag of the load lacks then decays with its
time constant, and its law is fitted to that as well: its numbers are bent, and their intervals do not say so.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from hybridid.effects.composed import ComposedLaw
from hybridid.effects.over import RECENT_LOAD
from hybridid.naming import listed
from hybridid.simulation.windows import cut
from hybridid.trace.horizons.split import Split
from hybridid.trace.ports.path import Path
from hybridid.trace.refits.refitted import Refit
from hybridid.trace.search.steps import Accepted

LOADED = 0.5
"""Of the load's RMS over the first horizon of a record: with so much a record begins under load."""


def memory_begins_empty(accepted: Sequence[Accepted], final: Refit, split: Split) -> str:
    """Which of the ``accepted`` laws remember a load that a record begins with, in words; empty if none."""
    told = [
        one.name
        for one in accepted
        if _remembers_load(one) and _begins_loaded(one.trial.candidate.port, final, split)
    ]
    if not told:
        return ""
    return (
        f" Beware: {listed(told)} remembers the load, and its memory begins at nothing with each record. But "
        "a record begins under load here, so what was before it bends the numbers, beyond their intervals. "
        "Records that begin unloaded, or are much longer than the memory, show them."
    )


def _remembers_load(one: Accepted) -> bool:
    law = one.trial.candidate.effect.law
    return isinstance(law, ComposedLaw) and any(over.variable == RECENT_LOAD for over in law.overs)


def _begins_loaded(port: str, final: Refit, split: Split) -> bool:
    """Whether a record begins with at least ``LOADED`` of the RMS of the load at ``port``."""
    heads = np.flatnonzero(cut(split.records, split.horizon, 1).is_head).tolist()
    loads = [Path.of(final, split, [head]).motion(port, "load") for head in heads]
    return any(abs(load[0]) >= LOADED * np.sqrt(np.mean(load**2)) > 0 for load in loads)
