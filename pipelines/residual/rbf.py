"""``residual=rbf``: radial basis functions inside the equations, their number chosen on held-out blocks."""

from __future__ import annotations

import itertools
import time
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

from joblib import cpu_count

from hybridid.hybrid import PortHybrid
from hybridid.model import Model
from hybridid.residuals.held_out import Candidate, Mapper, Scored, choose, compare
from hybridid.residuals.rbf import Over, RBFBounds
from hybridid.residuals.rbf_fit import Physics, RBFPlan, fit_rbf, port_of
from hybridid.settings.fit import FitSettings
from pipelines.residual.request import GrayBox, Made, Request, reporter, section_of
from pipelines.shared.errors import ConfigError
from pipelines.shared.watch import Watcher
from pipelines.shared.workers import workers


@dataclass(frozen=True)
class RBFRequest(Request):
    """The keys of the section. Several ``nodes`` or ``horizons`` are chosen from on ``folds`` blocks of
    the fitted records, each held out in turn; ``horizons`` None is the gray box' own. ``judged``: on those
    blocks, though there may be nothing to choose from."""

    nodes: tuple[int, ...] = (8,)
    horizons: tuple[int | None, ...] | None = None
    port: str | None = None
    over: Over = "velocity"
    span: tuple[float, float] | None = None
    physics: Physics = "refitted"
    bounds: RBFBounds = field(default_factory=RBFBounds)
    max_iterations: int = 30
    folds: int = 4
    processes: int | None = None
    judged: bool = False

    def __post_init__(self) -> None:
        if not self.nodes or self.horizons == ():
            raise ValueError("residual.nodes and residual.horizons: give at least one number")
        if self.folds < 2:
            raise ValueError(f"residual.folds is {self.folds}: at least 2")
        if self.processes is not None and self.processes < 1:
            raise ValueError(f"residual.processes is {self.processes}: at least 1, or null for one a core")
        for nodes in self.nodes:
            self._plan(nodes)
        for horizon in self.horizons or ():
            self._settings(FitSettings(), horizon)

    @classmethod
    def of(cls, section: Mapping[str, Any]) -> RBFRequest:
        return section_of(cls, section)

    def check(self, model: Model) -> None:
        try:
            port_of(model, self._plan(self.nodes[0]))
        except ValueError as error:
            raise ConfigError(str(error)) from error

    def make(self, gray: GrayBox, watcher: Watcher) -> Made:
        began = time.perf_counter()
        candidates = self._candidates(gray.estimate.settings)
        scored: list[Scored] = []
        if len(candidates) > 1 or self.judged:
            with workers(self.processes or cpu_count()) as mapper:
                counted = _counted(mapper, watcher, (len(candidates) + 1) * self.folds)
                scored = compare(
                    gray.model, gray.records, candidates, gray.estimate.settings, self.folds, counted
                )
        best = choose(scored) if scored else None
        candidate = best.candidate if best else candidates[0]
        values = gray.estimate.values
        found = fit_rbf(
            gray.model, values, gray.records, candidate.plan, candidate.settings, reporter(watcher)
        )
        hybrid = PortHybrid(
            gray=gray.model,
            values=found.estimate.values,
            network=found.network,
            port=port_of(gray.model, candidate.plan),
            records=tuple(record.name for record in gray.records),
            learned_from=" and ".join(sorted({record.provenance for record in gray.records})),
        )
        units = [signal.unit for signal in gray.model.outputs]
        report = {
            "nodes": candidate.plan.nodes,
            "horizon": candidate.settings.horizon,
            "physics": candidate.plan.physics,
            "candidates": [_row(one, one is best, units) for one in scored],
            "rule": RULE if scored else None,
            "seconds": time.perf_counter() - began,
        }
        notes = tuple(w for w in found.estimate.warnings if ".rbf." not in w)
        return Made(hybrid, report, notes, found.estimate)

    def _candidates(self, gray: FitSettings) -> list[Candidate]:
        horizons = (gray.horizon,) if self.horizons is None else self.horizons
        return [Candidate(self._plan(n), self._settings(gray, h)) for h in horizons for n in self.nodes]

    def _plan(self, nodes: int) -> RBFPlan:
        return RBFPlan(nodes, self.port, self.over, self.span, self.physics, self.bounds)

    def _settings(self, gray: FitSettings, horizon: int | None) -> FitSettings:
        return replace(gray, horizon=horizon, max_iterations=self.max_iterations, starts=1)


RULE = (
    "the fewest nodes whose error on held-out blocks of the fitted records is within one standard error "
    "of the lowest; among those the lowest"
)


def _counted(mapper: Mapper, watcher: Watcher, total: int) -> Mapper:
    """``mapper``, telling the watcher of each result of all its calls."""
    finished = itertools.count(1)

    def count(function: Any, arguments: Any) -> Any:
        for result in mapper(function, arguments):
            done = next(finished)
            watcher.progress("networks on held-out blocks", f"{done} of {total}", done / total)
            yield result

    return count


def _row(one: Scored, chosen: bool, units: list[str]) -> dict[str, Any]:
    return {
        "nodes": one.candidate.plan.nodes,
        "horizon": one.candidate.settings.horizon,
        "rmse": list(map(float, one.rmse)),
        "gray_rmse": list(map(float, one.gray_rmse)),
        "units": units,
        "score": one.score,
        "standard_error": one.standard_error,
        "failures": sorted({f.failure for f in one.folds if f.failure}),
        "chosen": chosen,
    }
