"""How a trace solves the equations: what no verdict may depend on."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from hybridid.estimators.method import GAUSS_NEWTON, Method
from hybridid.estimators.problem import Problem, build_problem
from hybridid.model import Model
from hybridid.records.channel import Channel
from hybridid.records.record import Hold, Record
from hybridid.simulation.chosen import EXPLICIT, integrator_for
from hybridid.simulation.stability import substeps_wanted
from hybridid.trace.horizons.split import Split

Array = NDArray[np.float64]
MARGIN = 1.1
"""Steps a sample in hand: parameters move."""


@dataclass(frozen=True)
class Numerics:
    """``smoothing`` multiplies every epsilon, ``finer`` the steps a sample; ``hold`` replaces how the
    inputs whose hold is only assumed run between samples (None: as assumed). ``method`` descends."""

    name: str = "as declared"
    smoothing: float = 1.0
    finer: int = 1
    integrator: str = "rk4"
    hold: Hold | None = None
    method: Method = GAUSS_NEWTON

    def records(self, split: Split) -> tuple[Record, ...]:
        """The records, their inputs held as this says."""
        if self.hold is None:
            return split.records
        return tuple(
            replace(r, input_channels=tuple(self._held(c) for c in r.input_channels), warnings=())
            for r in split.records
        )

    def _held(self, channel: Channel) -> Channel:
        return replace(channel, hold=self.hold) if channel.assumed and self.hold else channel

    def problem(self, model: Model, split: Split, steps: int) -> Problem:
        """Every horizon of ``split``, in ``steps`` times ``finer`` steps a sample."""
        steps *= self.finer
        problem = build_problem(model, self.records(split), split.horizon, steps, integrator=self.integrator)
        return problem.without_ends(split.gap)

    def steps(self, model: Model, p: Array, split: Split, paths: Sequence[Array] | None = None) -> int:
        """Steps a sample that ``p`` (n_p,) needs; ``paths`` as ``substeps_wanted`` has them."""
        return substeps_wanted(model, p, self.records(split), MARGIN, self.integrator, paths)


DECLARED = Numerics()


def numerics_for(model: Model, split: Split, starts: Sequence[Mapping[str, float]], asked: str) -> Numerics:
    """The numerics with the integrator ``asked``; for "auto" RK4, unless every one of the ``starts`` (values
    by name) needs the implicit one."""
    needed = {integrator_for(model, model.values(start), split.records, asked) for start in starts}
    return Numerics(integrator=EXPLICIT if EXPLICIT in needed else needed.pop())
