"""``residual=narx``: a network on the error of each output, chosen from a grid of sizes and seeds."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, fields
from typing import TYPE_CHECKING, Any

from hybridid.estimators.estimate import Progress
from hybridid.hybrid import FittedHybrid, GrayBox, errors_of, gray_runs
from hybridid.hybrid.gray_box import Errors
from hybridid.hybrid.narx_grid import narx_hybrid, networks_to_train, train_networks
from hybridid.model import Model
from hybridid.residuals.orders import Orders, orders_of
from hybridid.residuals.settings import Architecture, Training
from pipelines.residual.request import Request, section_of
from pipelines.shared.errors import ConfigError, unknown
from pipelines.shared.watch import Watcher

if TYPE_CHECKING:
    from hybridid.residuals.training import Task

_OF_TRAINING = tuple(f.name for f in fields(Training))


@dataclass(frozen=True)
class _Orders:
    error: int
    gray: int
    inputs: Any = 0


@dataclass(frozen=True)
class _Shape:
    """The keys beside those of ``Training``."""

    orders: _Orders
    outputs: tuple[str, ...] | None = None
    depth: tuple[int, ...] = (3,)
    width: tuple[int, ...] = (16,)
    every: int = 1
    increment: bool = False
    seeds: tuple[int, ...] = (0,)
    initial_state: str = "estimated"


@dataclass(frozen=True)
class NARXRequest(Request):
    """Networks of every depth and width of ``shape`` and every seed, trained by ``training``."""

    shape: _Shape
    training: Training = field(default_factory=Training)

    @classmethod
    def of(cls, section: Mapping[str, Any]) -> NARXRequest:
        names = {f.name for f in fields(_Shape)} | set(_OF_TRAINING)
        for key in section:
            if key != "kind" and key not in names:
                raise ConfigError(unknown("config key below residual", key, sorted(names)))
        own = {key: value for key, value in section.items() if key not in _OF_TRAINING}
        rest = {key: value for key, value in section.items() if key in _OF_TRAINING}
        shape = section_of(_Shape, own)
        for name in ("depth", "width", "seeds"):
            if not getattr(shape, name):
                raise ConfigError(f"residual.{name} is []: give at least one number")
        if shape.initial_state not in ("estimated", "measured"):
            raise ConfigError(
                unknown("value of residual.initial_state", shape.initial_state, ("estimated", "measured"))
            )
        return cls(shape, section_of(Training, rest))

    def check(self, model: Model) -> None:
        outputs = [signal.name for signal in model.outputs]
        for name in self.shape.outputs or ():
            if name not in outputs:
                raise ConfigError(unknown("output in residual.outputs", name, outputs))
        try:
            self.architectures(model)
        except ValueError as error:
            raise ConfigError(str(error)) from error

    def make(self, gray: GrayBox, watcher: Watcher) -> FittedHybrid:
        began = time.perf_counter()
        runs = gray_runs(gray, self.shape.initial_state)
        trained = train_networks(self.tasks(gray.model, errors_of(runs)), self.training, told(watcher))
        return narx_hybrid(gray, runs, trained, time.perf_counter() - began)

    def tasks(self, model: Model, errors: Errors) -> list[Task]:
        """Every network, size after size, on what the gray box leaves of the fitted records."""
        return networks_to_train(errors, self.architectures(model), self._outputs(model), self.shape.seeds)

    def _outputs(self, model: Model) -> tuple[str, ...]:
        return self.shape.outputs or tuple(signal.name for signal in model.outputs)

    def architectures(self, model: Model) -> list[Architecture]:
        """One for each depth and width.

        Raises:
            ValueError: if an order or a size is not allowed.
        """
        given, shape, inputs = self.shape.orders, self.shape, [signal.name for signal in model.inputs]
        orders: Orders = orders_of(given.error, given.inputs, given.gray, inputs)
        return [
            Architecture(orders, depth, width, shape.every, shape.increment)
            for depth in shape.depth
            for width in shape.width
        ]


def told(watcher: Watcher) -> Callable[[str, Progress], None]:
    """Hands the reports of a training to the watcher."""
    return lambda name, report: watcher.progress(
        name,
        f"{report.stage}, epoch {report.iteration}, held-out share {report.cost:.3g}",
        report.fraction,
    )
