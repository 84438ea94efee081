"""``residual=narx``: a network on the error of each output, chosen from a grid of sizes and seeds."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from hybridid.demand import Demand
from hybridid.estimators.estimate import Progress
from hybridid.hybrid import FittedHybrid, GrayBox, errors_of, gray_runs
from hybridid.hybrid.gray_box import Errors
from hybridid.hybrid.narx_grid import narx_hybrid, networks_to_train, train_networks
from hybridid.model import Model
from hybridid.records.record import Record
from hybridid.residuals.demand import training_demand
from hybridid.residuals.orders import Orders, orders_of
from hybridid.residuals.settings import Architecture
from hybridid.settings.fit import FitSettings
from pipelines.residual.request import Request
from pipelines.shared.errors import ConfigError, unknown
from pipelines.shared.sections.residual import NARXSection
from pipelines.shared.watch import Watcher

if TYPE_CHECKING:
    from hybridid.residuals.training import Task


@dataclass(frozen=True)
class NARXRequest(NARXSection, Request):
    """Networks of every depth, width and seed."""

    def check(self, model: Model) -> None:
        outputs = [signal.name for signal in model.outputs]
        for name in self.outputs or ():
            if name not in outputs:
                raise ConfigError(unknown("output in residual.outputs", name, outputs))
        try:
            self.architectures(model)
        except ValueError as error:
            raise ConfigError(str(error)) from error

    def demand(self, model: Model, records: Sequence[Record], fitted: FitSettings) -> Demand:
        networks = len(self._outputs(model)) * len(self.seeds)
        samples = sum(record.n for record in records)
        return training_demand(self.architectures(model), networks, samples, self.training)

    def make(self, gray: GrayBox, watcher: Watcher) -> FittedHybrid:
        began = time.perf_counter()
        runs = gray_runs(gray, self.initial_state)
        trained = train_networks(self.tasks(gray.model, errors_of(runs)), self.training, report_to(watcher))
        return narx_hybrid(gray, runs, trained, time.perf_counter() - began)

    def tasks(self, model: Model, errors: Errors) -> list[Task]:
        """Every network, size after size, on the error of the gray box on the fitted records."""
        return networks_to_train(errors, self.architectures(model), self._outputs(model), self.seeds)

    def _outputs(self, model: Model) -> tuple[str, ...]:
        return self.outputs or tuple(signal.name for signal in model.outputs)

    def architectures(self, model: Model) -> list[Architecture]:
        """One for each depth and width.

        Raises:
            ValueError: if an order or a size is not allowed.
        """
        given, inputs = self.orders, [signal.name for signal in model.signals]
        orders: Orders = orders_of(given.error, given.inputs, given.gray, inputs)
        return [
            Architecture(orders, depth, width, self.every, self.increment)
            for depth in self.depth
            for width in self.width
        ]


def report_to(watcher: Watcher) -> Callable[[str, Progress], None]:
    """Hands the reports of a training to the watcher."""
    return lambda name, report: watcher.progress(
        name,
        f"{report.stage}, epoch {report.iteration}, held-out share {report.cost:.3g}",
        report.fraction,
    )
