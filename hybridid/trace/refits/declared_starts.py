"""Where the fit of the declared model starts: by regression, and at the guesses."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from hybridid.estimators.start import regression_start
from hybridid.model import Model
from hybridid.trace.horizons.split import Split


def declared_starts(
    model: Model, split: Split, start: Sequence[Mapping[str, float]] = ()
) -> Sequence[Mapping[str, float]]:
    """Where the fit of the declared model starts: at ``start``, or by regression and at the guesses. Where
    the motion hides a parameter, regression strays."""
    return start or [regressed(model, split), {}]


def regressed(model: Model, split: Split) -> dict[str, float]:
    """Parameter values to start from: by regression on the fitted records, else the guesses."""
    start = regression_start(model, split.fitted_records)
    values = model.values() if start is None else start
    return {q.name: float(v) for q, v in zip(model.parameters, values, strict=True)}
