"""One trial: networks of one size, trained by one setting, on the gray box that all trials share."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from hybridid.estimators.estimate import Progress
from hybridid.hybrid import GrayBox, GrayRun, errors_of
from hybridid.hybrid.narx_grid import HeldOut, held_out_of
from pipelines.residual.narx import NARXRequest
from pipelines.residual.stage import request_of
from pipelines.shared.watch import Watcher
from pipelines.tune.request import Value, with_values

if TYPE_CHECKING:
    from optuna import Trial

    from pipelines.shared.config import Settings

OBJECTIVE = (
    "the network's free-run RMSE on the held-out blocks over that of no network, root mean square over "
    "outputs and seeds"
)
_BETWEEN = 2  # per cent of the training, between two reports: each is a line in the journal


@dataclass(frozen=True, eq=False)
class Bench:
    """What all trials share: the config, the gray box and its simulations."""

    settings: Settings
    gray: GrayBox
    runs: Sequence[GrayRun]


@dataclass(frozen=True)
class Found:
    """How well the networks do, and how long they took to train."""

    held_out: HeldOut
    seconds: float


def narx_of(settings: Settings, values: Mapping[str, Value]) -> NARXRequest:
    """The networks that a trial with these values asks for."""
    request = request_of(with_values(settings, values))
    assert isinstance(request, NARXRequest)
    return request


def carried_out(
    bench: Bench, values: Mapping[str, Value], trial: Trial | None, name: str, watcher: Watcher
) -> Found:
    """Train the networks of ``values``.

    Raises:
        TrialPruned: if the trial is not worth finishing.
        ValueError: if it cannot be done.
    """
    from hybridid.residuals.training import train_stack  # torch takes seconds to import

    request = narx_of(bench.settings, values)
    began = time.perf_counter()
    tasks = request.tasks(bench.gray.model, errors_of(bench.runs))
    trained = train_stack(tasks, request.training, _reporter(trial, name, watcher))
    return Found(held_out_of(trained), time.perf_counter() - began)


def _reporter(trial: Trial | None, name: str, watcher: Watcher) -> Callable[[Progress], None]:
    """A function that reports the error to the study, and stops the trial if the study prunes it."""
    from optuna import TrialPruned

    last = -_BETWEEN

    def report(progress: Progress) -> None:
        nonlocal last
        percent = round(100 * (progress.fraction or 0.0))
        share = float(np.sqrt(progress.cost))
        watcher.progress(name, f"{percent} %, held-out share {share:.3g}", progress.fraction)
        if trial is None or percent < last + _BETWEEN or percent >= 100:
            return
        last = percent
        trial.report(share, percent)
        if trial.should_prune():
            raise TrialPruned(f"at {percent} % of its training")

    return report
