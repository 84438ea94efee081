"""A tracking server: runs go there with their files; one that is down, or never answers, costs no result."""

from __future__ import annotations

import os
import socket
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
import requests

from hybridid_cli.main import dispatch
from pipelines.tracking import log as tracking
from pipelines.tracking import patience
from pipelines.tracking.note import KEY
from pipelines.tracking.parent_run import parent_run
from pipelines.tracking.runs import Point, client, log_point
from pipelines.tracking.waiting import waiting


@pytest.fixture
def port() -> int:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])


@contextmanager
def serving(port: int) -> Iterator[None]:
    """MLflow's own server on ``port``, which keeps the artifacts too."""
    words = [sys.executable, "-m", "mlflow", "server", "--host", "127.0.0.1", "--port", str(port)]
    words += ["--workers", "1", "--backend-store-uri", "sqlite:///server.db"]
    words += ["--artifacts-destination", str(Path("kept").resolve())]
    environment = {**os.environ, "MLFLOW_SERVER_ENABLE_JOB_EXECUTION": "false"}
    with Path("server.log").open("w") as log:
        server = subprocess.Popen(words, stdout=log, stderr=log, env=environment, process_group=0)
    try:
        end = time.monotonic() + 120
        while not _answers(port):
            assert server.poll() is None, Path("server.log").read_text()
            assert time.monotonic() < end, "the server does not start"
            time.sleep(0.2)
        yield
    finally:
        os.killpg(server.pid, 9)
        server.wait()


def _answers(port: int) -> bool:
    try:
        return requests.get(f"http://127.0.0.1:{port}/health", timeout=5).ok
    except requests.ConnectionError:
        return False


def test_what_a_server_that_is_down_did_not_take_is_sent_when_it_is_up(
    settings, heard, port, monkeypatch, capsys
):
    monkeypatch.setattr(patience, "_paused", {})
    uri = f"http://127.0.0.1:{port}"
    there = settings({"mlflow.tracking_uri": uri})
    Path("files").mkdir()
    Path("files/curve.json").write_text("[1]")
    point = Point(
        "first", "width=8", {"residual.width": 8}, {"held_out": 0.5}, 1_700_000_000.0, 2.0,
        artifacts=[Path("files")],
    )  # fmt: skip
    began = time.monotonic()
    log_point(there, point, "all", heard)
    with parent_run(there, "sweep", "all", heard) as parent:
        parent.open({})
        parent.close()
    assert time.monotonic() - began < 30
    assert uri in heard.warned[0]
    assert "does not answer" in heard.warned[0]
    assert len(waiting(there)) == 3

    assert dispatch(["log", "case=emps"]) == 1
    assert "3 runs still wait" in capsys.readouterr().err
    with serving(port):
        assert dispatch(["log", "case=emps"]) == 0
        said = capsys.readouterr().out
        assert f"sent width=8 of short to {uri}" in said
        assert "no run waits" in said
        monkeypatch.setattr(patience, "_paused", {})
        log_point(there, point, "all", heard)  # up now: sent at once, and there already
        store = client(there)
        runs = store.search_runs([store.get_experiment_by_name("short").experiment_id])
        by_key = {run.data.tags[KEY]: run for run in runs}
        assert len(runs) == len(by_key) == 2
        first, parent = by_key["first"], by_key["all"]
        assert first.data.tags["mlflow.parentRunId"] == parent.info.run_id
        assert {run.info.status for run in runs} == {"FINISHED"}
        assert first.data.metrics == {"held_out": 0.5}
        assert [f.path for f in store.list_artifacts(first.info.run_id)] == ["files"]
    assert waiting(there) == []
    assert [p.read_text() for p in Path("kept").rglob("curve.json")] == ["[1]"]


def test_server_that_never_answers_is_not_waited_for(settings, heard, monkeypatch):
    monkeypatch.setattr(patience, "_paused", {})
    monkeypatch.setattr(tracking, "_warned", set())
    monkeypatch.setenv("MLFLOW_HTTP_REQUEST_TIMEOUT", "1")
    monkeypatch.setattr(patience, "ANSWER", 1.0)
    with socket.socket() as mute:
        mute.bind(("127.0.0.1", 0))
        mute.listen()
        there = settings({"mlflow.tracking_uri": f"http://127.0.0.1:{mute.getsockname()[1]}"})
        began = time.monotonic()
        for key in range(20):
            log_point(there, Point(f"{key}", f"width={key}", {}, {}, 0.0, 1.0), "all", heard)
        assert time.monotonic() - began < 20, "every point waited for the server anew"
    assert len(heard.warned) == 1
    assert {note.key for _, note in waiting(there)} == {str(key) for key in range(20)}
