"""Training of NARX networks, many at once (``train_stack``) or one (``train``)."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from hybridid.estimators.estimate import Progress
from hybridid.residuals.course import Course
from hybridid.residuals.criteria import Criterion, FreeRunError, HorizonError, without_correction
from hybridid.residuals.narx import NARX
from hybridid.residuals.orders import Orders
from hybridid.residuals.regressors import Scaling
from hybridid.residuals.samples import Samples, check_lengths, samples_of
from hybridid.residuals.second_order import Descended, Descent
from hybridid.residuals.series import ErrorSeries
from hybridid.residuals.settings import Architecture, Epoch, Training
from hybridid.residuals.stack import new_stack, one_thread, padded_orders

Report = Callable[[Progress], None]


@dataclass(frozen=True, eq=False)
class Task:
    """One network to train, on the errors of one output over one or several records."""

    series: tuple[ErrorSeries, ...]
    architecture: Architecture
    seed: int = 0


@dataclass(frozen=True, eq=False)
class Trained:
    """A trained network and the results of its training.

    ``held_out`` is the RMS error on the held-out blocks in a simulation from an error of zero, ``zero`` that
    without correction, both in ``unit``. ``stopped`` says why the training on each horizon ended.
    """

    network: NARX
    held_out: float
    zero: float
    unit: str
    history: tuple[Epoch, ...]
    stopped: tuple[str, ...]
    seconds: float


def train(task: Task, settings: Training, report: Report | None = None) -> Trained:
    """Train one network: ``train_stack`` with one task."""
    return train_stack([task], settings, report)[0]


def train_stack(tasks: Sequence[Task], settings: Training, report: Report | None = None) -> list[Trained]:
    """Train networks together, of any orders, depths and widths, on one thread.

    Each network's weights, batches and stopping depend only on its own task. ``seconds`` is the time for the
    whole stack.

    Raises:
        ValueError: if the tasks do not fit into one stack, an error is zero throughout, or the blocks
            are too short for horizons and orders.
    """
    if settings.optimiser == "lbfgs":
        return _one_by_one(tasks, settings, report)
    began = time.perf_counter()
    architectures = [task.architecture for task in tasks]
    scalings = [Scaling.of(task.series, task.architecture.every) for task in tasks]
    gains = [_gain(task, scaling) for task, scaling in zip(tasks, scalings, strict=True)]
    with one_thread():
        stack = new_stack(architectures, [task.seed for task in tasks], gains, settings.precision)
        samples = _samples(tasks, scalings, settings, stack.lags)
        limits = [settings.guard * _largest(t) / s.error for t, s in zip(tasks, scalings, strict=True)]
        free_run = FreeRunError(samples, limits)
        criterion: Criterion = free_run
        if settings.criterion == "horizon":
            criterion = HorizonError.of(samples, settings.windows[-1], stack.lags)
        course = Course(stack, samples, criterion, settings, [task.seed for task in tasks])
        for stage, length in enumerate(settings.windows):
            course.run(length, _reporter(report, stage, settings))
        held_out = free_run(course.best, range(len(tasks)))
    seconds = time.perf_counter() - began
    return [
        _trained(
            Descended((course.best.weights(k),), tuple(course.history[k]), tuple(course.stopped[k])),
            task,
            scalings[k],
            (held_out[k], without_correction(samples[k])),
            settings,
            seconds,
        )
        for k, task in enumerate(tasks)
    ]


def _one_by_one(tasks: Sequence[Task], settings: Training, report: Report | None) -> list[Trained]:
    """``optimiser=lbfgs``: one network after another, in double precision."""
    began, found = time.perf_counter(), []
    exact = replace(settings, precision="double")
    for k, task in enumerate(tasks):
        one, scaling = task.architecture, Scaling.of(task.series, task.architecture.every)
        samples = samples_of(task.series, scaling, one, one.orders, exact)
        check_lengths(samples, settings, task.series[0].seen.output)
        limit = settings.guard * _largest(task) / scaling.error
        descent = Descent(one, samples, settings, _gain(task, scaling), limit)
        done = descent.run(task.seed, _part_of(report, k, len(tasks)))
        free_run = FreeRunError([samples], [limit])
        square = free_run.of(done.members, 0, one.orders.error, float(one.increment))
        found.append((done, task, scaling, (square, without_correction(samples)), settings))
    seconds = time.perf_counter() - began
    return [_trained(*one, seconds) for one in found]


def _part_of(
    report: Report | None, number: int, count: int
) -> Callable[[int | None, int, float, float], None]:
    """Reports one network's training as a part of all."""

    def tell(horizon: int | None, epoch: int, held_out: float, done: float) -> None:
        if report:
            length = "whole record" if horizon is None else f"horizon {horizon}"
            name = f"network {number + 1} of {count}, {length}"
            report(Progress(name, epoch, held_out, (number + done) / count))

    return tell


def _samples(
    tasks: Sequence[Task], scalings: Sequence[Scaling], settings: Training, lags: int
) -> list[Samples]:
    exogenous = padded_orders([task.architecture for task in tasks])
    padded = Orders(lags, exogenous[:-1], exogenous[-1])
    made: dict[tuple[object, ...], Samples] = {}
    for task, scaling in zip(tasks, scalings, strict=True):
        key = (task.series, task.architecture.every, task.architecture.orders.longest)
        if key not in made:
            made[key] = samples_of(task.series, scaling, task.architecture, padded, settings)
            check_lengths(made[key], settings, task.series[0].seen.output)
    found = [made[(t.series, t.architecture.every, t.architecture.orders.longest)] for t in tasks]
    if len({s.trained_on for s in found}) > 1:
        raise ValueError("networks of one stack are trained on records of the same length and grid")
    return found


def _gain(task: Task, scaling: Scaling) -> float:
    """RMS value of the predicted quantity over that of the error."""
    if not task.architecture.increment:
        return 1.0
    every = task.architecture.every
    parts = [np.diff(s.error[piece][::every]) for s in task.series for piece in s.seen.pieces]
    steps = np.concatenate(parts)
    steps = steps[np.isfinite(steps)]
    return (float(np.sqrt(np.mean(steps**2))) / scaling.error if len(steps) else 0.0) or 1.0


def _reporter(report: Report | None, stage: int, settings: Training) -> Callable[[int, float], None]:
    def tell(epoch: int, held_out: float) -> None:
        if report:
            done = (stage + epoch / settings.epochs) / len(settings.windows)
            report(Progress(f"network, horizon {settings.windows[stage]}", epoch, held_out, done))

    return tell


def _largest(task: Task) -> float:
    return max(float(np.nanmax(np.abs(s.error))) for s in task.series)


def _trained(
    found: Descended,
    task: Task,
    scaling: Scaling,
    squares: tuple[float, float],
    settings: Training,
    seconds: float,
) -> Trained:
    seen = task.series[0].seen
    network = NARX(
        output=seen.output,
        unit=seen.unit,
        dt=seen.dt,
        input_names=seen.input_names,
        architecture=task.architecture,
        scaling=scaling,
        members=found.members,
        limit=settings.guard * _largest(task),
        seed=task.seed,
        records=tuple(s.record for s in task.series),
        provenance=" and ".join(sorted({s.provenance for s in task.series})),
    )
    held_out, zero = (square**0.5 * scaling.error for square in squares)
    return Trained(
        network=network,
        held_out=float(held_out),
        zero=zero,
        unit=seen.unit,
        history=found.history,
        stopped=found.stopped,
        seconds=seconds,
    )
