"""Whether a drive had settled before the record, or was switched on with it.

A lag or a delay of a drive passes on what the input was before. Of the time before a record nothing is known.
So the drive is at rest there: at the input's first sample, or at zero, if the input was switched on with the
record. The two differ in the first horizon alone, but there perhaps by far more than the sensor's noise. The
records decide: what explains more of the fitted horizons is taken.
"""

from __future__ import annotations

import math
from dataclasses import replace

from hybridid.trace.candidates import Candidate
from hybridid.trace.horizons.split import Split
from hybridid.trace.refits.refit import refit_if_possible
from hybridid.trace.refits.refitted import Refit


def settled_or_switched_on(found: Refit, candidate: Candidate, split: Split) -> Refit:
    """``found``, the refit with ``candidate`` settled before each record, or the one with the input switched
    on with it, if that explains more. What the config fixes stays. So does ``found`` where each record begins
    with a zero of the input."""
    name = _share_of(found, candidate, split)
    if not name or "fixed" in found.model.adjustments.get(name, {}):
        return found
    model = replace(found.model, adjustments={**found.model.adjustments, name: {"fixed": 0.0}})
    again = refit_if_possible(model, split, [{**found.values, name: 0.0}], found, found.numerics, math.inf)
    return found if again is None or again.cost >= found.cost else again


def _share_of(found: Refit, candidate: Candidate, split: Split) -> str:
    """The parameter that says whether the input of ``candidate`` was there before the records; empty if that
    makes no difference."""
    return next(
        (
            state.begins_by
            for state in found.model.states
            if state.name.startswith(f"{candidate.name}.")
            and state.begins_as is not None
            and state.begins_by is not None
            and any(record.input(state.begins_as)[0] != 0.0 for record in split.records)
        ),
        "",
    )
