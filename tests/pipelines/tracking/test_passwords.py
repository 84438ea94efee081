"""The password of a tracking server: in no file, and there when a run that waited is sent."""

from __future__ import annotations

import base64
import json
import threading
from collections.abc import Iterator
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import Any

import pytest
import yaml

from pipelines.runner import run_stages
from pipelines.shared import secrets
from pipelines.shared.storage import write_json
from pipelines.tracking import log, patience
from pipelines.tracking.runs import Point, log_point
from pipelines.tracking.store import client, tracking_uri
from pipelines.tracking.waiting import folder, send_waiting, waiting

PASSWORD = "s3cret-Pa55word"
SHOWN = f"Basic {base64.b64encode(f'alice:{PASSWORD}'.encode()).decode()}"


@pytest.fixture(autouse=True)
def apart(monkeypatch, own_folder):
    for name in (secrets.USERNAME, secrets.PASSWORD, secrets.DATABASE_PASSWORD):
        monkeypatch.setenv(name, "")  # so that what a test sets is taken back
        monkeypatch.delenv(name)
    monkeypatch.setenv("XDG_CONFIG_HOME", str(own_folder / "config"))
    monkeypatch.setenv("MLFLOW_HTTP_REQUEST_MAX_RETRIES", "0")
    monkeypatch.setattr(patience, "_paused", {})
    monkeypatch.setattr(log, "_warned", set())


class Guarded(BaseHTTPRequestHandler):
    """Knows one experiment, and who may ask for it."""

    shown: list[str]

    def do_GET(self) -> None:
        self.shown.append(self.headers.get("Authorization", ""))
        good = self.shown[-1] == SHOWN
        found = {"experiment_id": "7", "name": "short", "lifecycle_stage": "active"}
        self.send_response(200 if good else 401)
        self.send_header("Content-Type", "application/json")
        self.end_headers()
        self.wfile.write(json.dumps({"experiment": found} if good else {"message": "who?"}).encode())

    do_POST = do_GET

    def log_message(self, *given: Any) -> None:
        pass


@pytest.fixture
def server() -> Iterator[str]:
    """The address of a server that asks for a password, on this machine."""
    Guarded.shown = []
    with ThreadingHTTPServer(("127.0.0.1", 0), Guarded) as guarded:
        threading.Thread(target=guarded.serve_forever, daemon=True).start()
        yield f"127.0.0.1:{guarded.server_address[1]}"
        guarded.shutdown()


def files_with_it(root: Path) -> list[str]:
    forms = [PASSWORD.encode(), SHOWN.encode()]
    return [str(p) for p in root.rglob("*") if p.is_file() and any(form in p.read_bytes() for form in forms)]


def test_the_client_shows_it_to_the_server(settings, server):
    there = settings({"mlflow.tracking_uri": f"http://alice:{PASSWORD}@{server}"})
    assert tracking_uri(there) == f"http://{server}"
    assert client(there).get_experiment_by_name("short").experiment_id == "7"


def test_it_is_in_no_file_that_a_run_leaves_and_in_no_line(settings, heard, data, own_folder):
    there = settings({"mlflow.tracking_uri": f"http://alice:{PASSWORD}@127.0.0.1:9"})
    tree = run_stages(there, "preprocess", heard).tree
    point = Point(
        "one",
        "a point",
        {"uri": f"http://alice:{PASSWORD}@h"},
        {},
        began=0.0,
        seconds=1.0,
        error=f"no {PASSWORD}",
        artifacts=[tree / "config.yaml"],
    )
    log_point(there, point, "all", heard)
    (attempt,) = send_waiting(there, heard)
    assert attempt.trouble
    assert files_with_it(own_folder) == []
    assert PASSWORD not in "".join([*heard.warned, *heard.said, str(attempt)])
    assert "if MLFLOW_TRACKING_USERNAME and MLFLOW_TRACKING_PASSWORD are set as now" in heard.warned[-1]
    stored = yaml.safe_load((tree / "config.yaml").read_text())
    assert stored["mlflow"]["tracking_uri"] == "http://127.0.0.1:9"


def test_what_could_hold_such_things_is_not_for_everybody(settings, heard, data):
    there = settings({"mlflow.tracking_uri": "http://127.0.0.1:9"})
    tree = run_stages(there, "preprocess", heard).tree
    assert (tree / "config.yaml").stat().st_mode & 0o777 == 0o600
    log_point(there, Point("one", "a point", {}, {}, 0.0, 1.0), "all", heard)
    ((place, _),) = waiting(there)
    assert place.stat().st_mode & 0o777 == 0o700


def test_a_run_that_waited_finds_the_password_in_the_environment(settings, heard, server, monkeypatch):
    there = settings({"mlflow.tracking_uri": f"http://{server}"})
    log_point(there, Point("one", "a point", {}, {}, 0.0, 1.0), "all", heard)
    assert set(Guarded.shown) == {""}
    assert len(waiting(there)) == 1
    Guarded.shown.clear()
    monkeypatch.setenv(secrets.USERNAME, "alice")
    monkeypatch.setenv(secrets.PASSWORD, PASSWORD)
    list(send_waiting(settings(), heard))
    assert set(Guarded.shown) == {SHOWN}


def received(there, **changes):
    """A waiting run that somebody else wrote."""
    place = folder(there) / "1-received"
    place.mkdir(parents=True)
    note = {"key": "k", "name": "n", "experiment": "short", "uri": None, "began": 0, "ended": 1, **changes}
    lists = {"metrics": [], "artifacts": [], "tags": {}, "params": {}, "parent": None, "status": "FINISHED"}
    write_json(place / "note.json", {**lists, **note})
    return place


def test_a_received_run_is_sent_nowhere_by_itself(settings, heard, server):
    place = received(settings(), uri=f"http://{server}")
    (attempt,) = send_waiting(settings(), heard)
    said = f"you never logged to this store from here; mlflow.tracking_uri=http://{server} sends it"
    assert attempt.trouble == said
    assert Guarded.shown == []
    assert place.exists()


@pytest.mark.parametrize("how", ["absolute", "upwards", "link"])
def test_a_received_run_takes_no_file_of_ones_own_along(settings, heard, server, own_folder, how):
    (own_folder / "id_rsa").write_text("private")
    source = {"absolute": str(own_folder / "id_rsa"), "upwards": "../../../id_rsa", "link": "files"}[how]
    place = received(settings(), artifacts=[{"source": source, "into": ""}])
    if how == "link":
        (place / "files").mkdir()
        (place / "files" / "x").symlink_to(own_folder / "id_rsa")
    (attempt,) = send_waiting(settings({"mlflow.tracking_uri": f"http://{server}"}), heard)
    assert "lies outside of" in attempt.trouble
    assert Guarded.shown == []
