"""Runs whose process is told to end or is killed: each is ended in MLflow, and no run that goes on is."""

from __future__ import annotations

import errno
import multiprocessing
import os
import platform
import shutil
import signal
import sqlite3
import time
from contextlib import closing
from dataclasses import replace
from pathlib import Path

import pytest
from mlflow.store.tracking.sqlalchemy_store import SqlAlchemyStore

from pipelines.tracking import begun
from pipelines.tracking import log as tracking
from pipelines.tracking import send as tracking_send
from pipelines.tracking import store as store_module
from pipelines.tracking.abandoned import REASON, end_abandoned
from pipelines.tracking.begun import Mark
from pipelines.tracking.note import KEY
from pipelines.tracking.parent_run import parent_run
from pipelines.tracking.runs import Point, client, log_point
from pipelines.tracking.store import STORE
from pipelines.tracking.waiting import send_waiting, waiting

POINT = Point("point", "width=8", {}, {}, began=1_700_000_000.0, seconds=2.0)


MADE_BY_MLFLOW = store_module._make


@pytest.fixture(autouse=True)
def store(empty_store, settings):
    """The store of each test, which no process has opened."""
    Path("outputs").mkdir()
    shutil.copy(empty_store(), "outputs")


@pytest.fixture(autouse=True)
def fresh_memory(monkeypatch):
    monkeypatch.setattr(tracking, "_looked", set())
    monkeypatch.setattr(tracking, "_warned", set())


@pytest.fixture
def opened(settings, heard):
    """``opened()``: a process that has opened the run of a sweep and goes on."""
    fork, started = multiprocessing.get_context("fork"), []

    def opens(ready):
        with parent_run(settings(), "sweep", "all", heard) as parent:
            parent.open({})
            ready.set()
            time.sleep(600)

    def start():
        ready = fork.Event()
        process = fork.Process(target=opens, args=(ready,))
        process.start()
        started.append(process)
        assert ready.wait(60)
        return process

    yield start
    for process in started:
        killed(process)


def killed(process):
    process.kill()
    process.join()


def runs(settings):
    store = client(settings)
    found = store.search_runs([store.get_experiment_by_name("short").experiment_id])
    return {run.data.tags[KEY]: (run.info.status, run.data.tags.get("error", "")) for run in found}


def test_a_run_whose_process_was_killed_is_ended_by_the_next_command(settings, heard, opened):
    there = settings()
    process = opened()
    log_point(there, POINT, "other", heard)
    assert runs(there)["all"] == ("RUNNING", ""), "its process lives"
    killed(process)
    tracking._looked.clear()
    log_point(there, POINT, "other", heard)
    assert runs(there)["all"] == ("KILLED", REASON)
    assert heard.warned == []
    with parent_run(there, "sweep", "all", heard) as parent:  # the same sweep again is the same run again
        parent.open({})
        assert runs(there)["all"] == ("RUNNING", "")
        parent.close()
    assert runs(there)["all"] == ("FINISHED", "")
    assert list(Path("outputs/.mlflow-running").iterdir()) == []


def test_a_run_that_another_process_goes_on_with_is_left_alone(settings, heard, opened):
    there = settings()
    one, _ = opened(), opened()
    killed(one)
    assert end_abandoned(there) == ""
    assert runs(there)["all"] == ("RUNNING", "")
    assert len(list(Path("outputs/.mlflow-running").iterdir())) == 1


def test_a_run_of_another_machine_is_left_alone(settings, heard, opened, monkeypatch):
    there = settings()
    killed(opened())
    with monkeypatch.context() as patch:
        patch.setattr(platform, "node", lambda: "elsewhere")
        assert end_abandoned(there) == ""
    assert runs(there)["all"] == ("RUNNING", "")
    assert end_abandoned(settings({"mlflow.tracking_uri": "sqlite:///other.db"})) == ""
    assert runs(there)["all"] == ("RUNNING", "")


def test_the_end_of_a_run_that_waits_to_be_sent_waits_behind_it(settings, heard, opened, monkeypatch):
    there = settings()
    with monkeypatch.context() as patch:
        patch.setattr(tracking, "send", lambda *given: 1 / 0)
        killed(opened())
    assert end_abandoned(there) == ""
    assert [note.status for _, note in waiting(there)] == ["RUNNING", "KILLED"]
    assert [attempt.trouble for attempt in send_waiting(there, heard)] == ["", ""]
    assert runs(there)["all"] == ("KILLED", REASON)


@pytest.mark.parametrize(
    ("error", "status"), [(KeyboardInterrupt("interrupted"), "KILLED"), (OSError("disk full"), "FAILED")]
)
def test_a_sweep_that_is_broken_off_is_ended_at_once(settings, heard, error, status):
    with pytest.raises(type(error)):
        _broken_off(settings(), heard, error)
    assert runs(settings())["all"] == (status, f"{type(error).__name__}: {error}")
    assert list(Path("outputs/.mlflow-running").iterdir()) == []


def _broken_off(settings, heard, error):
    with parent_run(settings, "sweep", "all", heard) as parent:
        parent.open({})
        raise error


def test_a_sweep_that_is_broken_off_before_it_began_leaves_no_run(settings, heard):
    with pytest.raises(KeyboardInterrupt), parent_run(settings(), "sweep", "all", heard):
        raise KeyboardInterrupt
    assert [p.name for p in Path("outputs").iterdir()] == [STORE]
    assert client(settings()).get_experiment_by_name("short") is None


@pytest.mark.parametrize("where", ["_run_of", "_parts"])
def test_a_run_that_is_struck_while_it_is_begun_or_filled_is_ended(settings, heard, monkeypatch, where):
    its = getattr(tracking_send, where)

    def struck(*given):
        its(*given)
        raise KeyboardInterrupt

    monkeypatch.setattr(tracking_send, where, struck)
    with pytest.raises(KeyboardInterrupt), parent_run(settings(), "sweep", "all", heard) as parent:
        parent.open({})
    assert runs(settings())["all"][0] == "KILLED"


def test_a_signal_while_the_store_is_written_acts_when_it_is_whole(settings, heard, monkeypatch):
    """Cut off in a transaction, the file stayed locked for 20 s, the run RUNNING, and the exit code was 0."""
    there = settings()
    its = SqlAlchemyStore.log_batch

    def struck(*given, **named):
        os.kill(os.getpid(), signal.SIGINT)
        return its(*given, **named)

    monkeypatch.setattr(SqlAlchemyStore, "log_batch", struck)
    with pytest.raises(KeyboardInterrupt):
        log_point(there, POINT, "all", heard)
    assert runs(there)["point"] == ("FINISHED", "")
    assert heard.warned == []


def full(*given, **named):
    raise OSError(errno.ENOSPC, "No space left on device")


def test_a_run_that_a_full_disk_cuts_off_and_does_not_keep_is_ended_by_the_next_command(
    settings, heard, monkeypatch
):
    there = settings()
    with monkeypatch.context() as patch:
        patch.setattr(tracking_send, "_parts", full)
        patch.setattr(tracking, "keep", full)
        log_point(there, POINT, "all", heard)
    assert runs(there)["point"] == ("RUNNING", "")
    assert "No space left on device" in heard.warned[-1]
    log_point(there, replace(POINT, key="another"), "all", heard)
    assert runs(there)["point"] == ("KILLED", REASON)
    assert list(Path("outputs/.mlflow-running").iterdir()) == []


def test_what_a_store_that_fails_makes_mlflow_log_is_no_traceback_on_the_terminal(settings, heard, capsys):
    there = settings()
    client(there)
    with closing(sqlite3.connect(Path("outputs") / STORE)) as database:
        database.execute("alter table params rename to gone")
        database.commit()
    log_point(there, replace(POINT, params={"width": 8}), "all", heard)
    (warning,) = heard.warned
    assert "no such table" in warning
    assert capsys.readouterr().err == ""


def test_a_folder_that_a_full_disk_does_not_keep_is_told_in_a_few_words(settings, heard, monkeypatch):
    Path("tree").mkdir()
    for name in "ab":
        Path("tree", name).write_text(name)
    monkeypatch.setattr(tracking, "send", full)
    monkeypatch.setattr(shutil, "copyfile", full)
    log_point(settings(), replace(POINT, artifacts=[Path("tree")]), "all", heard)
    (warning,) = heard.warned
    assert warning.startswith("not logged to MLflow (OSError: [Errno 28] No space left on device)")


def test_a_sweep_whose_end_finds_the_disk_full_is_ended_by_the_next_command(settings, heard, monkeypatch):
    there = settings()
    with parent_run(there, "sweep", "all", heard) as parent:
        parent.open({})
        with monkeypatch.context() as patch:
            patch.setattr(tracking, "send", full)
            patch.setattr(tracking, "keep", full)
            parent.close()
    assert end_abandoned(there) == ""
    assert runs(there)["all"] == ("KILLED", REASON)


def test_a_run_that_is_kept_goes_on_until_it_is_sent(settings, heard, monkeypatch):
    there = settings()
    with monkeypatch.context() as patch:
        patch.setattr(tracking_send, "_parts", full)
        log_point(there, POINT, "all", heard)
        assert [attempt.trouble != "" for attempt in send_waiting(there, heard)] == [True]
    assert end_abandoned(there) == ""
    assert runs(there)["point"] == ("RUNNING", "")
    assert [attempt.trouble for attempt in send_waiting(there, heard)] == [""]
    assert runs(there)["point"] == ("FINISHED", "")


def test_a_mark_is_locked_as_long_as_it_is_there(settings):
    mark = Mark("all", "short", settings())
    (place,) = Path("outputs/.mlflow-running").iterdir()
    assert not place.name.startswith(".")
    with pytest.raises(OSError, match="held"):
        _lock(place / "lock")
    mark.lift()
    assert not place.exists()


def _lock(path):
    import fcntl

    with path.open() as file:
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError as held:
            raise OSError("held") from held


def test_a_store_whose_making_was_cut_off_is_made_anew(settings, monkeypatch):
    Path("outputs", STORE).unlink()
    monkeypatch.setattr(store_module, "_make", MADE_BY_MLFLOW)

    def cut_off(uri, process):
        Path(uri.removeprefix("sqlite:///")).write_text("half of a store")
        raise KeyboardInterrupt

    with monkeypatch.context() as patch:
        patch.setattr(store_module, "_client", cut_off)
        with pytest.raises(KeyboardInterrupt):
            client(settings())
    assert client(settings()).get_experiment_by_name("short") is None
    assert [p.name for p in Path("outputs").iterdir() if p.name.startswith(".mlflow.db")] == []


def test_a_mark_that_cannot_be_written_leaves_nothing(settings, monkeypatch):
    """On a full disk its folder stayed."""

    def full(path, data):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(begun, "write_json", full)
    with pytest.raises(OSError, match="No space"):
        Mark("key", "short", settings())
    assert list(Path("outputs/.mlflow-running").iterdir()) == []
