"""``residual=rbf``: radial basis functions inside the equations, their number chosen on held-out blocks."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from contextlib import nullcontext
from dataclasses import dataclass, replace
from itertools import starmap
from typing import Any

from hybridid.demand import Demand
from hybridid.estimators.demand import fit_demand
from hybridid.hybrid import FittedHybrid, GrayBox
from hybridid.hybrid.rbf_grid import rbf_hybrid
from hybridid.model import Model
from hybridid.records.record import Record
from hybridid.residuals.held_out import Candidate, Mapper
from hybridid.residuals.rbf_fit import RBFPlan, port_of
from hybridid.settings.fit import FitSettings
from pipelines.residual.request import Request, reporter
from pipelines.shared.errors import ConfigError
from pipelines.shared.pool import core_count, mapper_of
from pipelines.shared.sections.residual import RBFSection
from pipelines.shared.watch import Watcher


@dataclass(frozen=True)
class RBFRequest(RBFSection, Request):
    """Networks of ``nodes`` numbers of nodes, fitted over ``horizons``."""

    def check(self, model: Model) -> None:
        try:
            port_of(model, self._plan(self.nodes[0]))
        except ValueError as error:
            raise ConfigError(str(error)) from error

    def demand(self, model: Model, records: Sequence[Record], fitted: FitSettings) -> Demand:
        parts = [
            fit_demand(model, records, candidate.settings, candidate.plan.nodes)
            for candidate in self._candidates(fitted)
        ]
        largest = max(parts, key=lambda part: part.memory)
        return replace(largest, seconds=sum(part.seconds for part in parts))

    def make(self, gray: GrayBox, watcher: Watcher) -> FittedHybrid:
        candidates = self._candidates(gray.estimate.settings)
        judged = self.judged or len(candidates) > 1
        with mapper_of(self.processes or core_count()) if judged else nullcontext(starmap) as mapper:
            counted = _counted(mapper, watcher, (len(candidates) + 1) * self.folds)
            return rbf_hybrid(gray, candidates, self.folds, judged, counted, reporter(watcher))

    def _candidates(self, gray: FitSettings) -> list[Candidate]:
        horizons = (gray.horizon,) if self.horizons is None else self.horizons
        settings = [replace(gray, horizon=h, max_iterations=self.max_iterations, starts=1) for h in horizons]
        return [Candidate(self._plan(n), one) for one in settings for n in self.nodes]

    def _plan(self, nodes: int) -> RBFPlan:
        return RBFPlan(nodes, self.port, self.over, self.span, self.physics, self.bounds)


def _counted(mapper: Mapper, watcher: Watcher, total: int) -> Mapper:
    """``mapper``, telling the watcher of each result of all its calls."""
    finished = itertools.count(1)

    def count(function: Any, arguments: Any) -> Any:
        for result in mapper(function, arguments):
            done = next(finished)
            watcher.progress("networks on held-out blocks", f"{done} of {total}", done / total)
            yield result

    return count
