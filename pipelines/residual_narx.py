"""``residual=narx``: a network on the error of each output, several seeds trained together."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field, fields
from typing import TYPE_CHECKING, Any

from hybridid.hybrid import OutputErrorHybrid
from hybridid.model import Model
from hybridid.residuals.orders import Orders, orders_of
from hybridid.residuals.series import ErrorSeries, error_series
from hybridid.residuals.settings import Architecture, Training
from hybridid.validation import free_run
from pipelines.errors import ConfigError, unknown
from pipelines.residual_request import GrayBox, Made, Request, reporter, section_of
from pipelines.watch import Watcher

if TYPE_CHECKING:
    from hybridid.residuals.training import Trained

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
    depth: int = 3
    width: int = 16
    every: int = 1
    increment: bool = False
    seeds: tuple[int, ...] = (0,)
    initial_state: str = "estimated"


@dataclass(frozen=True)
class NARXRequest(Request):
    """Networks of one ``shape``, trained by ``training``."""

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
        if not shape.seeds:
            raise ConfigError("residual.seeds is []: give at least one number")
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
            self._architecture(model)
        except ValueError as error:
            raise ConfigError(str(error)) from error

    def make(self, gray: GrayBox, watcher: Watcher) -> Made:
        from hybridid.residuals.training import Task, train_stack  # torch takes seconds to import

        outputs = self.shape.outputs or tuple(signal.name for signal in gray.model.outputs)
        series = {name: self._series(gray, name) for name in outputs}
        architecture = self._architecture(gray.model)
        tasks = [Task(series[name], architecture, seed) for name in outputs for seed in self.shape.seeds]
        trained = train_stack(tasks, self.training, reporter(watcher))
        best = [_best(trained, name) for name in outputs]
        hybrid = OutputErrorHybrid(gray.model, gray.estimate.values, tuple(b.network for b in best))
        report = {
            "networks": [_row(one, one in best) for one in trained],
            "history": {one.network.output: [asdict(epoch) for epoch in one.history] for one in best},
            "seconds": trained[0].seconds,
        }
        return Made(hybrid, report, tuple(one.warning for one in best if one.warning))

    def _series(self, gray: GrayBox, output: str) -> tuple[ErrorSeries, ...]:
        values, integrator = gray.estimate.values, gray.estimate.settings.integrator
        runs = (
            (free_run(gray.model, values, r, self.shape.initial_state, integrator), r) for r in gray.records
        )
        return tuple(error_series(run, record, output) for run, record in runs)

    def _architecture(self, model: Model) -> Architecture:
        given, inputs = self.shape.orders, [signal.name for signal in model.inputs]
        orders: Orders = orders_of(given.error, given.inputs, given.gray, inputs)
        return Architecture(
            orders, self.shape.depth, self.shape.width, self.shape.every, self.shape.increment
        )


def _best(trained: Sequence[Trained], output: str) -> Trained:
    """The seed with the lowest free-run error on the held-out blocks."""
    return min((one for one in trained if one.network.output == output), key=lambda one: one.held_out)


def _row(one: Trained, chosen: bool) -> dict[str, Any]:
    return {
        "output": one.network.output,
        "seed": one.network.seed,
        "weights": one.network.weights.count,
        "held_out": one.held_out,
        "without": one.zero,
        "unit": one.unit,
        "stopped": list(one.stopped),
        "chosen": chosen,
    }
