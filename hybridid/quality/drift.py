"""The free runs that are bad by nature, since the model integrates or is unstable; see
``hybridid.validation.drift``."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from hybridid.model import Model
from hybridid.quality.trial import MOST_OF
from hybridid.quality.verdict import View
from hybridid.records.record import Record
from hybridid.validation.drift import outputs_that_drift

Array = NDArray[np.float64]


def explained_over_horizons(views: Sequence[View]) -> list[View]:
    """The views over horizons in which the model explains most of the motion."""
    return [v for v in views if v.horizon is not None and v.rmse**2 < MOST_OF * v.nothing**2]


def drifting(views: Sequence[View], model: Model, p: Array, records: Sequence[Record]) -> list[View]:
    """The free runs among ``views`` that are no better than doing nothing, of outputs that drift, where the
    model explains most of the motion over horizons."""
    good = {v.output for v in explained_over_horizons(views)}
    poor = [v for v in views if v.horizon is None and v.worse_than_nothing and v.output in good]
    if not poor:
        return []
    drift = dict(zip((one.name for one in model.outputs), outputs_that_drift(model, p, records), strict=True))
    return [v for v in poor if drift[v.output]]
