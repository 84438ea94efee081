"""``Refit``: a model fitted on the fitted horizons, and what it leaves on the held-out ones."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hybridid.estimators.problem import Problem
from hybridid.model import Model
from hybridid.trace.horizons.score import Score
from hybridid.trace.horizons.split import Split
from hybridid.trace.refits.numerics import DECLARED, Numerics

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Refit:
    """A model fitted on the split's fitted horizons, and its score on the held-out ones.

    ``x0`` (w, n_x) are the initial states of all horizons, fitted and held out; ``numerics`` say how its
    equations were solved, in ``substeps`` a sample. ``std`` and ``correlation`` are those of the noise alone,
    empty where they were not asked for.

    ``unsolved`` are the numbers of the starts that were left out as too stiff, or that diverged with a new
    inner state, whose stiffness no path of the poorer model shows. It is ``too_stiff`` if it is not stable at
    the end in as many steps as there is room for (``refit_starts.is_too_stiff``). In either case the
    integrator may have decided, not the records. It ``ended_early`` if no start was hopeful. ``shorter``:
    over shorter horizons, if that differs. It has ``two_minima`` if its fit that begins there ends in another
    local minimum of the cost.
    """

    model: Model
    values: Mapping[str, float]
    std: Mapping[str, float]
    correlation: Array
    x0: Array
    fitted_rmse: Array
    score: Score
    cost: float
    status: str
    converged: bool
    seconds: float
    substeps: int
    numerics: Numerics = DECLARED
    unsolved: tuple[int, ...] = ()
    too_stiff: bool = False
    ended_early: bool = False
    shorter: Refit | None = None
    two_minima: bool = False

    def problem(self, split: Split) -> Problem:
        """Every horizon of ``split`` as the problem that was solved."""
        return self.numerics.problem(self.model, split, self.steps)

    @property
    def steps(self) -> int:
        """Steps a sample, before ``numerics`` make each shorter."""
        return self.substeps // self.numerics.finer


def values_without(refitted: Refit, name: str) -> dict[str, float]:
    """The parameter values of ``refitted`` without those of the effect ``name``."""
    kept = {p.name for p in refitted.model.without(name).parameters}
    return {key: value for key, value in refitted.values.items() if key in kept}
