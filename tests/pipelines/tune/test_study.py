"""The study: a number of trials that several workers share exactly, whoever of them is killed."""

from __future__ import annotations

import multiprocessing
import os
from pathlib import Path

import pytest
from optuna.trial import TrialState

from pipelines.tune.findings import findings_of
from pipelines.tune.request import Range, TuneRequest
from pipelines.tune.study import ERROR, counts, next_trial, opened, seated

SPACE = {"residual.width": Range(4, 64, log=True), "residual.learning_rate": Range(1e-4, 1e-1, log=True)}


@pytest.fixture
def folder() -> Path:
    path = Path("search")
    path.mkdir()
    return path


def finish(study, trial, share, weights):
    trial.set_user_attr("weights", weights)
    study.tell(trial, share)


def test_no_worker_begins_more_than_is_asked_for(folder):
    request = TuneRequest(SPACE, trials=3)
    with seated(folder) as one, seated(folder) as two:
        assert one != two
        first, second = opened(folder, request, one), opened(folder, request, two)
        a, b, c = (next_trial(s, request, n, folder) for s, n in ((first, one), (second, two), (first, one)))
        assert {a.number, b.number, c.number} == {0, 1, 2}
        assert next_trial(second, request, two, folder) is None
        finish(first, a, 0.5, 10)
        assert next_trial(second, request, two, folder) is None
    widths = {trial.params["residual.width"] for trial in (a, b, c)}
    assert all(isinstance(width, int) and 4 <= width <= 64 for width in widths)


def test_more_trials_go_on_from_those_that_are_there(folder):
    for trials in (2, 3):
        request = TuneRequest(SPACE, trials=trials)
        with seated(folder) as seat:
            study = opened(folder, request, seat)
            while trial := next_trial(study, request, seat, folder):
                finish(study, trial, 1.0 / (1 + trial.number), 10)
        assert len(opened(folder, request).trials) == trials


def dies_at_work(folder: Path) -> None:
    request = TuneRequest(SPACE, trials=2)
    with seated(folder) as seat:
        next_trial(opened(folder, request, seat), request, seat, folder)
        os._exit(9)


def test_a_trial_of_a_killed_worker_is_ended_and_done_again(folder):
    request = TuneRequest(SPACE, trials=2)
    process = multiprocessing.get_context("fork").Process(target=dies_at_work, args=(folder,))
    process.start()
    process.join()
    with seated(folder) as seat:
        study = opened(folder, request, seat)
        assert [trial.state for trial in study.trials] == [TrialState.RUNNING]
        numbers = []
        while trial := next_trial(study, request, seat, folder):
            numbers.append(trial.number)
            finish(study, trial, 0.5, 10)
    assert numbers == [1, 2]
    assert [row.state for row in findings_of(study).rows] == ["stopped", "done", "done"]
    assert not counts(study.trials[0])


def test_a_trial_of_a_living_worker_is_left_alone(folder):
    request = TuneRequest(SPACE, trials=2)
    with seated(folder) as one, seated(folder) as two:
        study = opened(folder, request, one)
        mine = next_trial(study, request, one, folder)
        next_trial(opened(folder, request, two), request, two, folder)
        assert study.trials[mine.number].state == TrialState.RUNNING


def test_the_same_seed_alone_makes_the_same_search(folder):
    request = TuneRequest(SPACE, trials=4, startup=2, seed=7)
    found = []
    for name in ("one", "two"):
        place = folder / name
        place.mkdir()
        with seated(place) as seat:
            study = opened(place, request, seat)
            while trial := next_trial(study, request, seat, place):
                finish(study, trial, trial.params["residual.learning_rate"], 10)
        found.append([trial.params for trial in study.trials])
    assert found[0] == found[1]


def test_the_smallest_of_the_nearly_best_is_chosen_and_failures_are_named(folder):
    request = TuneRequest(SPACE, trials=4)
    with seated(folder) as seat:
        study = opened(folder, request, seat)
        for share, weights in ((0.40, 900), (0.41, 100), (0.50, 10)):
            finish(study, next_trial(study, request, seat, folder), share, weights)
        broken = next_trial(study, request, seat, folder)
        broken.set_user_attr(ERROR, "ValueError: no")
        study.tell(broken, state=TrialState.FAIL)
        assert next_trial(study, request, seat, folder) is None, "a failure is a trial too"
    findings = findings_of(study)
    assert findings.chosen.number == 1
    assert [row.number for row in findings.best] == [0, 1, 2]
    (failed,) = findings.of("failed")
    assert (failed.number, failed.remark) == (3, "ValueError: no")
