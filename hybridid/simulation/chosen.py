"""Which integrator solves a model, where the settings leave it open."""

from __future__ import annotations

from collections.abc import Sequence
from typing import cast, get_args

import numpy as np
from numpy.typing import NDArray

from hybridid.model import Model
from hybridid.records.record import Record
from hybridid.settings.choices import AskedIntegrator, Integrator
from hybridid.simulation.stability import IMPLICIT, MOST, substeps_wanted

AUTO: AskedIntegrator = "auto"
EXPLICIT: Integrator = "rk4"
MARGIN = 1.1
"""Steps in hand: parameters move."""


def integrator_for(
    model: Model, p: NDArray[np.float64], records: Sequence[Record], asked: str = AUTO
) -> Integrator:
    """``asked``; for "auto" RK4, or the implicit one where RK4 needs more than ``MOST`` steps a sample at
    ``p`` (n_p,)."""
    if asked != AUTO:
        return as_integrator(asked)
    return EXPLICIT if substeps_wanted(model, p, records, MARGIN) <= MOST else IMPLICIT


def as_integrator(name: str) -> Integrator:
    """The integrator of this name.

    Raises:
        ValueError: if there is none.
    """
    for known in get_args(Integrator):
        if name == known:
            return cast(Integrator, known)
    raise ValueError(f"unknown integrator {name!r}: known: {', '.join(get_args(Integrator))}")
