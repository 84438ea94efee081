"""Starts of a limit that an input exceeds most of the time.

Where a drive passes a small part of what is asked of it, inertia, friction and limit can be scaled together,
and the motion hardly changes. With the limit at a part of the largest input, a regression on smoothed
derivatives (``hybridid.estimators.start``) scales all other parameters at once.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from hybridid.estimators.start import regression_start
from hybridid.model import Model
from hybridid.trace.candidates import Candidate
from hybridid.trace.horizons.split import Split
from hybridid.trace.starts.load_starts import sought_by

PARTS = (1 / 2, 1 / 4, 1 / 8)
"""Of the largest input, at which the limit begins."""


def with_limit_exceeded(candidate: Candidate, model: Model, split: Split) -> list[dict[str, float]]:
    """Starts of the augmented ``model``; none where the effect has no limit, or a state is not measured."""
    limit = sought_by(candidate, "limit")
    if not limit:
        return []
    columns = [k for k, signal in enumerate(model.inputs) if signal.name in candidate.ports]
    largest = max(float(np.abs(record.inputs[:, columns]).max()) for record in split.fitted_records)
    if not largest > 0:
        return []
    guessed = {p.name: p.guess for p in model.parameters if p.name.startswith(f"{candidate.name}.")}
    starts = [regressed_beside({**guessed, limit: 1.0 / (part * largest)}, model, split) for part in PARTS]
    return [start for start in starts if start is not None]


def regressed_beside(known: Mapping[str, float], model: Model, split: Split) -> dict[str, float] | None:
    """Values with the parameters ``known`` of ``model`` as given, and all others by regression. None beyond
    their bounds, or where a state is not measured."""
    declared = {p.name: p for p in model.parameters}
    if not all(declared[name].lower <= value <= declared[name].upper for name, value in known.items()):
        return None
    fixed = {name: {"fixed": value} for name, value in known.items()}
    start = regression_start(replace(model, adjustments={**model.adjustments, **fixed}), split.fitted_records)
    return None if start is None else dict(zip(declared, start.tolist(), strict=True))
