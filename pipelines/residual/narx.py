"""``residual=narx``: a network on the error of each output, chosen from a grid of sizes and seeds."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass, field, fields
from typing import TYPE_CHECKING, Any

from hybridid.estimators.estimate import Progress
from hybridid.hybrid import OutputErrorHybrid
from hybridid.model import Model
from hybridid.residuals.choice import RULE, smallest_near_best
from hybridid.residuals.orders import Orders, orders_of
from hybridid.residuals.series import ErrorSeries, error_series
from hybridid.residuals.settings import SMALL, Architecture, Training
from pipelines.residual.request import GrayBox, Made, Request, section_of
from pipelines.residual.scores import GrayRun, gray_runs, gray_scores, hybrid_scores
from pipelines.shared.errors import ConfigError, unknown
from pipelines.shared.watch import Watcher

if TYPE_CHECKING:
    from hybridid.residuals.training import Task, Trained

Errors = Mapping[str, tuple[ErrorSeries, ...]]
"""By output, one for each record."""
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

    def make(self, gray: GrayBox, watcher: Watcher) -> Made:
        began = time.perf_counter()
        runs = gray_runs(gray, self.shape.initial_state)
        trained = train_networks(self.tasks(gray.model, errors_of(runs)), self.training, watcher)
        return self.made(gray, runs, trained, time.perf_counter() - began)

    def tasks(self, model: Model, errors: Errors) -> list[Task]:
        """Every network, size after size, on what the gray box leaves of the fitted records."""
        from hybridid.residuals.training import Task  # torch takes seconds to import

        return [
            Task(errors[name], one, seed)
            for one in self.architectures(model)
            for name in self._outputs(model)
            for seed in self.shape.seeds
        ]

    def made(
        self, gray: GrayBox, runs: Sequence[GrayRun], trained: Sequence[Trained], seconds: float
    ) -> Made:
        """The hybrid of the networks to keep of ``trained``, which are those of ``tasks``."""
        outputs = self._outputs(gray.model)
        best = [smallest_near_best([one for one in trained if one.network.output == o]) for o in outputs]
        hybrid = OutputErrorHybrid(gray.model, gray.estimate.values, tuple(b.network for b in best))
        rows = [
            {**_row(one, one in best), "hybrid": hybrid_scores(gray, runs, one.network)} for one in trained
        ]
        report = {
            "networks": rows,
            "gray": gray_scores(runs, outputs),
            "rule": RULE,
            "history": {one.network.output: [asdict(epoch) for epoch in one.history] for one in best},
            "seconds": seconds,
        }
        useless = [one.warning for one in best if one.warning]
        lost = [one["remark"] for row in rows if row["chosen"] for one in row["hybrid"] if "remark" in one]
        return Made(hybrid, report, (*useless, *lost))

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


def train_networks(tasks: Sequence[Task], training: Training, watcher: Watcher) -> list[Trained]:
    """Every network of ``tasks``: small ones in one stack, each larger size in one of its own."""
    from hybridid.residuals.training import train_stack  # torch takes seconds to import

    stacks: dict[tuple[int, int] | None, list[int]] = {}
    for number, task in enumerate(tasks):
        one = task.architecture
        stacks.setdefault(None if one.width <= SMALL else (one.depth, one.width), []).append(number)
    trained: dict[int, Trained] = {}
    for count, (size, numbers) in enumerate(stacks.items()):
        name = f"{len(numbers)} networks " + (f"of {size[0]} x {size[1]}" if size else "side by side")
        report = _within(watcher, name, count, len(stacks))
        found = train_stack([tasks[k] for k in numbers], training, report)
        trained.update(zip(numbers, found, strict=True))
    return [trained[k] for k in range(len(tasks))]


def errors_of(runs: Sequence[GrayRun]) -> Errors:
    """What the gray box leaves of every output of the fitted records. Networks of one stack that get the very
    same errors share their windows."""
    fitted = [(run.prediction, run.record) for run in runs if run.fitted and run.prediction]
    return {
        output: tuple(error_series(prediction, record, output) for prediction, record in fitted)
        for output in fitted[0][0].output_names
    }


def _within(watcher: Watcher, name: str, number: int, stacks: int) -> Callable[[Progress], None]:
    """Tells the watcher of one stack's training as a part of all."""
    return lambda report: watcher.progress(
        name,
        f"{report.stage}, epoch {report.iteration}, held-out share {report.cost:.3g}",
        (number + (report.fraction or 0.0)) / stacks,
    )


def _row(one: Trained, chosen: bool) -> dict[str, Any]:
    return {
        "output": one.network.output,
        "depth": one.network.architecture.depth,
        "width": one.network.architecture.width,
        "seed": one.network.seed,
        "weights": one.network.weights.count,
        "held_out": one.held_out,
        "without": one.zero,
        "unit": one.unit,
        "stopped": list(one.stopped),
        "chosen": chosen,
    }
