"""A worker of the search: takes trial after trial from the study until there are enough."""

from __future__ import annotations

import time
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from hybridid.hybrid import gray_runs
from hybridid.plain import plain
from pipelines.residual.stage import gray_box
from pipelines.shared.config import Settings
from pipelines.shared.watch import Watcher
from pipelines.tracking.note import raised
from pipelines.tune.findings import row_of, said
from pipelines.tune.log import log_trial
from pipelines.tune.request import TuneRequest
from pipelines.tune.study import ERROR, next_trial, opened, seated
from pipelines.tune.trial import Bench, Found, carried_out, narx_of

if TYPE_CHECKING:
    from optuna import Study, Trial


@dataclass(frozen=True)
class WorkerTask:
    """``until`` is in s since 1970: no trial begins later."""

    settings: Settings
    gray_tree: Path
    folder: Path
    key: str
    until: float | None


def work(given: WorkerTask, watcher: Watcher) -> int:
    """Do trials until there are enough; returns how many this worker did."""
    request = TuneRequest.of(given.settings)
    gray = gray_box(given.settings, given.gray_tree)
    network = narx_of(given.settings, next(request.corners()))
    bench = Bench(given.settings, gray, gray_runs(gray, network.initial_state))
    done = 0
    with seated(given.folder) as seat:
        study = opened(given.folder, request, seat)
        while given.until is None or time.time() < given.until:
            trial = next_trial(study, request, seat, given.folder)
            if trial is None:
                break
            _done(study, trial, bench, watcher)
            done += 1
            row = row_of(study.trials[trial.number])
            watcher.say(f"trial {row.number}: {said(row.values)}: {row.outcome}")
            log_trial(given.settings, row, given.key, watcher)
    return done


def _done(study: Study, trial: Trial, bench: Bench, watcher: Watcher) -> None:
    """Carry out the trial and tell the study how it ended."""
    from optuna import TrialPruned
    from optuna.trial import TrialState

    try:
        found = carried_out(bench, trial.params, trial, f"trial {trial.number}", watcher)
    except TrialPruned as pruned:
        trial.set_user_attr("pruned", str(pruned))
        study.tell(trial, state=TrialState.PRUNED)
    except Exception as error:
        trial.set_user_attr(ERROR, raised(error, 300))
        study.tell(trial, state=TrialState.FAIL)
    except BaseException:  # told to stop: the next who comes does another in its place
        study.tell(trial, state=TrialState.FAIL)
        raise
    else:
        _tell(study, trial, found)


def _tell(study: Study, trial: Trial, found: Found) -> None:
    from optuna.trial import TrialState

    held_out = found.held_out
    trial.set_user_attr("weights", held_out.weights)
    trial.set_user_attr("outputs", plain(held_out.outputs))
    trial.set_user_attr("training_seconds", found.seconds)
    if np.isfinite(held_out.share):
        study.tell(trial, held_out.share)
    else:
        trial.set_user_attr("pruned", "every network diverged on the held-out blocks")
        study.tell(trial, state=TrialState.PRUNED)
