"""A sweep in MLflow: one parent, its points nested, and the same again is the same, not a second."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from pipelines.tracking import log as tracking
from pipelines.tracking import patience
from pipelines.tracking import send as tracking_send
from pipelines.tracking.note import COMMIT, KEY
from pipelines.tracking.parent_run import parent_run
from pipelines.tracking.runs import Point, client, log_point
from pipelines.tracking.waiting import send_waiting, waiting


@pytest.fixture(autouse=True)
def fresh_memory(monkeypatch):
    """What failed in one test is not remembered in the next."""
    monkeypatch.setattr(patience, "_paused", {})
    monkeypatch.setattr(tracking, "_warned", set())


def point(number, **changes):
    made = Point(
        key=f"point {number}",
        name=f"width={number}",
        params={"residual.width": number},
        metrics={"held_out": 0.1 * number, "ran_away": float("inf")},
        began=1_700_000_000.0,
        seconds=2.0,
    )
    return replace(made, **changes)


def runs_by_key(settings):
    store = client(settings)
    found = store.search_runs([store.get_experiment_by_name("short").experiment_id])
    by_key = {run.data.tags[KEY]: run for run in found}
    assert len(by_key) == len(found), "two runs of one key"
    return by_key


def sweep(settings, heard, points, failed=False):
    with parent_run(settings, "sweep", "all", heard) as parent:
        parent.open({"grid": "width"})
        for one in points:
            log_point(settings, one, "all", heard)
        parent.close(failed=failed, metrics={"best": 0.1})


def test_points_are_nested_below_their_sweep(settings, heard):
    sweep(settings(), heard, [point(1), point(2)])
    runs = runs_by_key(settings())
    assert set(runs) == {"all", "point 1", "point 2"}
    parent, one = runs["all"], runs["point 1"]
    assert one.data.tags["mlflow.parentRunId"] == parent.info.run_id
    assert (parent.info.status, parent.data.metrics) == ("FINISHED", {"best": 0.1})
    assert parent.data.tags["grid"] == "width"
    assert one.info.run_name == "width=1"
    assert one.data.params == {"residual.width": "1"}
    assert one.data.metrics == {"held_out": 0.1}
    assert one.info.end_time - one.info.start_time == 2000
    assert heard.warned == []


def test_the_same_sweep_again_completes_the_first(settings, heard):
    broken = point(2, error="killed by signal 9", metrics={})
    sweep(settings(), heard, [point(1), broken], failed=True)
    before = runs_by_key(settings())
    assert [before[k].info.status for k in ("all", "point 1", "point 2")] == ["FAILED", "FINISHED", "FAILED"]
    assert before["point 2"].data.tags["error"] == "killed by signal 9"
    sweep(settings(), heard, [point(1), point(2)])
    after = runs_by_key(settings())
    assert {k: run.info.run_id for k, run in after.items()} == {k: r.info.run_id for k, r in before.items()}
    assert {run.info.status for run in after.values()} == {"FINISHED"}
    assert "error" not in after["point 2"].data.tags
    assert len(client(settings()).get_metric_history(after["point 1"].info.run_id, "held_out")) == 1


def test_a_result_keeps_the_commit_that_made_it(settings, heard, monkeypatch):
    for commit in ("first", "later"):
        monkeypatch.setattr("pipelines.tracking.facts._commit", lambda commit=commit: {COMMIT: commit})
        log_point(settings(), point(1), "all", heard)
    assert runs_by_key(settings())["point 1"].data.tags[COMMIT] == "first"


def test_a_note_that_is_refused_does_not_stop_the_next(settings, heard):
    log_point(settings(), point(1, metrics={"a\nb": 1.0}), "all", heard)
    log_point(settings(), point(2), "all", heard)
    assert [note.key for _, note in waiting(settings())] == ["point 1"]
    assert runs_by_key(settings())["point 2"].info.status == "FINISHED"
    (attempt,) = send_waiting(settings(), heard)
    assert "a\\nb" in attempt.trouble or "metric" in attempt.trouble.lower()


def test_cut_off_midway_nothing_is_doubled_or_lost(settings, heard, monkeypatch):
    """The store dies after the run is begun: the rest of it comes later, into the same run."""
    Path("curve.json").write_text("[1]")

    def dies(*given):
        raise ConnectionError("gone")

    with monkeypatch.context() as patch:
        patch.setattr(tracking_send, "_upload", dies)
        log_point(settings(), point(1, artifacts=[Path("curve.json")]), "all", heard)
    Path("curve.json").unlink()  # kept as it was
    (begun,) = (run for key, run in runs_by_key(settings()).items() if key == "point 1")
    assert begun.info.status == "RUNNING"
    assert len(heard.warned) == 1
    for _ in range(2):
        assert all(not attempt.trouble for attempt in send_waiting(settings(), heard))
    done = runs_by_key(settings())["point 1"]
    assert (done.info.run_id, done.info.status) == (begun.info.run_id, "FINISHED")
    store = client(settings())
    assert len(store.get_metric_history(done.info.run_id, "held_out")) == 1
    assert [f.path for f in store.list_artifacts(done.info.run_id)] == ["curve.json"]
    assert waiting(settings()) == []


def test_sent_but_not_yet_removed_when_killed(settings, heard, monkeypatch):
    monkeypatch.setattr(tracking, "_sent", lambda note, settings: "down")
    log_point(settings(), point(1), "all", heard)
    with monkeypatch.context() as patch:
        patch.setattr("pipelines.tracking.waiting.remove", lambda place: None)
        assert [a.trouble for a in send_waiting(settings(), heard)] == [""]
    assert [a.trouble for a in send_waiting(settings(), heard)] == [""]
    assert set(runs_by_key(settings())) == {"all", "point 1"}
    assert waiting(settings()) == []


def test_one_warning_for_many_points_and_their_number_at_the_end(settings, heard, monkeypatch):
    def down(*given, **more):
        raise ConnectionError("refused")

    monkeypatch.setattr(tracking, "send", down)
    sweep(settings({"paths.outputs": "elsewhere"}), heard, [point(1), point(2), point(3)])
    first, last = heard.warned
    assert "ConnectionError: refused" in first
    assert "hybridid log paths.outputs=elsewhere" in first
    assert last.startswith("4 runs of this sweep wait")


def test_a_server_may_take_its_patience_and_no_longer(settings, heard, monkeypatch):
    there = client(settings())
    monkeypatch.setattr(tracking_send, "client", lambda settings, uri: there)
    monkeypatch.setattr("pipelines.tracking.waiting.answers", lambda uri: True)
    asked = settings({"mlflow.tracking_uri": "http://slow", "mlflow.patience": 0})
    log_point(asked, point(1), "all", heard)
    assert "more than 0 s (mlflow.patience)" in heard.warned[0]
    assert [note.key for _, note in waiting(asked)] == ["point 1"]
    assert [a.trouble for a in send_waiting(asked, heard)] == [""], "who sends later has time"
    assert set(runs_by_key(settings())) == {"all", "point 1"}
