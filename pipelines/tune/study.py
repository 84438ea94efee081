"""The study: trials in one journal file that processes and nodes share, on any file system that all see.

Each worker has a numbered seat: a file that it locks until it ends. If a trial is marked as running but the
seat of its worker is free, the worker was killed. Such a trial is ended and does not count.
"""

from __future__ import annotations

import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from filelock import FileLock, Timeout

from pipelines.tune.request import TuneRequest

if TYPE_CHECKING:
    from optuna import Study, Trial
    from optuna.pruners import BasePruner
    from optuna.trial import FrozenTrial

JOURNAL = "journal.log"
SEAT = "seat"
ERROR = "error"
_SEATS = "seats"
_WARM_UP = 20  # per cent of the training: before that, slow and hopeless networks look alike


@dataclass(frozen=True)
class Seat:
    """A worker's number, unique in the study, however many commands and nodes take part."""

    number: int


@contextmanager
def seated(folder: Path) -> Iterator[Seat]:
    """Take a seat for as long as the context lasts."""
    seats = folder / _SEATS
    seats.mkdir(parents=True, exist_ok=True)
    with FileLock(str(folder / ".lock")):
        number = len(list(seats.iterdir())) + 1
        lock = FileLock(str(_seat(folder, number)))
        lock.acquire(timeout=0)
    try:
        yield Seat(number)
    finally:
        lock.release()
        _seat(folder, number).touch()  # a seat is never given again, released or not


def opened(folder: Path, request: TuneRequest, seat: Seat | None = None) -> Study:
    """The study in ``folder``, made if there is none. Each seat draws random numbers of its own."""
    import optuna
    from optuna.storages import JournalStorage
    from optuna.storages.journal import JournalFileBackend

    optuna.logging.set_verbosity(optuna.logging.WARNING)
    seed = np.random.SeedSequence([request.seed, seat.number if seat else 0]).generate_state(1)[0]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", optuna.exceptions.ExperimentalWarning)
        return optuna.create_study(
            study_name="tune",
            storage=JournalStorage(JournalFileBackend(str(folder / JOURNAL))),
            sampler=optuna.samplers.TPESampler(
                n_startup_trials=request.startup, multivariate=True, seed=int(seed)
            ),
            pruner=_pruner(request),
            direction="minimize",
            load_if_exists=True,
        )


def next_trial(study: Study, request: TuneRequest, seat: Seat, folder: Path) -> Trial | None:
    """The next trial; None if the finished and the running ones already number ``request.trials``."""
    with FileLock(str(folder / ".lock")):
        end_orphans(study, folder)
        if sum(counts(trial) or not trial.state.is_finished() for trial in study.trials) >= request.trials:
            return None
        trial = study.ask(request.distributions())
        trial.set_user_attr(SEAT, seat.number)
        return trial


def counts(trial: FrozenTrial) -> bool:
    """Whether the trial counts: it ended with a value, pruned or with an error, and was not killed."""
    from optuna.trial import TrialState

    done = (TrialState.COMPLETE, TrialState.PRUNED)
    return trial.state in done or (trial.state == TrialState.FAIL and ERROR in trial.user_attrs)


def end_orphans(study: Study, folder: Path) -> int:
    """End the trials whose worker has ended; returns how many. The caller must hold the folder's lock."""
    from optuna.trial import TrialState

    ended = 0
    for trial in study.get_trials(deepcopy=False, states=(TrialState.RUNNING,)):
        number = trial.user_attrs.get(SEAT)
        if number is None or _is_free(_seat(folder, number)):
            study.tell(trial.number, state=TrialState.FAIL)
            ended += 1
    return ended


def _seat(folder: Path, number: int) -> Path:
    return folder / _SEATS / f"{number:05d}"


def _is_free(path: Path) -> bool:
    lock = FileLock(str(path))
    try:
        lock.acquire(timeout=0)
    except Timeout:
        return False
    lock.release()
    path.touch()
    return True


def _pruner(request: TuneRequest) -> BasePruner:
    """By the share of the training that is done, in per cent: a trial is ended that is worse than half of the
    others at the same share (median), or by successive halving (hyperband)."""
    from optuna import pruners

    if request.pruner == "none":
        return pruners.NopPruner()
    if request.pruner == "hyperband":
        return pruners.HyperbandPruner(min_resource=_WARM_UP, max_resource=100, reduction_factor=3)
    return pruners.MedianPruner(
        n_startup_trials=min(5, request.startup), n_warmup_steps=_WARM_UP, n_min_trials=3
    )
