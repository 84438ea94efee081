"""Jobs that a launcher loses: which of them are launched once more."""

from __future__ import annotations

from pathlib import Path

import pytest
from hydra.core.utils import JobReturn, JobStatus

from hybridid_cli.launching import BEGUN, OUTCOME, LauncherProcesses
from pipelines.shared.config import Settings
from pipelines.shared.errors import LostJob
from pipelines.shared.pool import Lost
from pipelines.shared.storage import read_json
from pipelines.sweep import job_runner
from pipelines.sweep.job_runner import LocalProcesses
from pipelines.sweep.point import Point
from pipelines.sweep.work import SweepJob

BY_CHANCE, NOT_BY_CHANCE = LostJob("job 7_1 is lost (failed)", True), LostJob("job 7_1 is lost (timeout)")


class Loses:
    """Loses the second job of its first ``times`` launches with ``error``, and does all others."""

    def __init__(self, error, times=1):
        self.error, self.times, self.launches = error, times, []

    def launch(self, jobs, initial_job_idx):
        paths = [Path(words[-1].removeprefix("sweep.job=")) for words in jobs]
        self.launches.append(jobs)
        return [self._job(path) for path in paths]

    def _job(self, path):
        path.with_suffix(BEGUN).touch()
        if read_json(path)["points"][0]["at"] == {"machine": "m1"} and self.times:
            self.times -= 1
            lost = JobReturn(status=JobStatus.FAILED)
            lost.return_value = self.error
            return lost
        path.with_suffix(OUTCOME).write_text("{}")
        return JobReturn(status=JobStatus.COMPLETED)


class Hears:
    """A watcher that notes the lines."""

    def __init__(self):
        self.lines = []

    def say(self, line):
        self.lines.append(line)

    warn = say


@pytest.fixture
def watcher():
    return Hears()


def two_jobs(stage):
    configs = [{"sweep": {"stage": stage}, "rig": {"path": "a:B", "seed": k}} for k in (0, 1)]
    points = [Point(Settings("emps", config), {"machine": f"m{k}"}) for k, config in enumerate(configs)]
    return [SweepJob(point.name, (point,)) for point in points]


def carried_out(launcher, tmp_path, watcher, stage="trace", **rest):
    jobs = two_jobs(stage)
    runner = LauncherProcesses(launcher, (), tmp_path, None, **rest)
    return runner.carry_out(jobs, watcher, lambda job, failures: None), jobs[1].points[0].key


def test_a_trace_lost_by_chance_is_launched_once_more(tmp_path, watcher):
    launcher = Loses(BY_CHANCE)
    failures, _ = carried_out(launcher, tmp_path, watcher)
    assert failures == {}
    assert [len(one) for one in launcher.launches] == [2, 1]
    assert "it is started once more and continues where it stopped" in watcher.lines[0]


def test_but_only_once(tmp_path, watcher):
    launcher = Loses(BY_CHANCE, times=9)
    failures, key = carried_out(launcher, tmp_path, watcher)
    assert len(launcher.launches) == 2
    assert "7_1 is lost (failed)" in failures[key]


@pytest.mark.parametrize(("error", "stage"), [(NOT_BY_CHANCE, "trace"), (BY_CHANCE, "auto")])
def test_a_cancelled_trace_and_a_network_are_named(error, stage, tmp_path, watcher):
    launcher = Loses(error)
    failures, key = carried_out(launcher, tmp_path, watcher, stage)
    assert len(launcher.launches) == 1
    assert "7_1 is lost" in failures[key]


def test_a_group_that_the_config_lacks_is_added(tmp_path, watcher):
    """As ``+machine=glob(*)`` asks: without the sign no job could compose its config."""
    launcher = Loses(BY_CHANCE, times=0)
    carried_out(launcher, tmp_path, watcher, added=frozenset({"machine"}))
    assert [words[0] for words in launcher.launches[0]] == ["+machine=m0", "+machine=m1"]


def test_a_trace_whose_process_is_killed_here_is_started_once_more(watcher, monkeypatch):
    rounds = []

    def side_by_side(work, tasks, processes, watcher_of):
        rounds.append(list(tasks))
        for name in tasks:
            watcher_of(name)
            yield name, Lost("its process was killed by SIGKILL") if name == "machine=m1" else {}

    monkeypatch.setattr(job_runner, "side_by_side", side_by_side)
    (first, second), ended = two_jobs("trace"), []
    failures = LocalProcesses(2).carry_out([first, second], watcher, lambda job, lost: ended.append(job))
    assert rounds == [["machine=m0", "machine=m1"], ["machine=m1"]]
    assert ended == [first, second]
    assert failures == {second.points[0].key: "its process was killed by SIGKILL"}
