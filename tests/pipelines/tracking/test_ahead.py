"""A short command sends its run from a process that has imported MLflow meanwhile."""

from __future__ import annotations

import sqlite3
from contextlib import closing

import pytest

from pipelines.tracking import log as log_module
from pipelines.tracking.ahead import imported_beside, sends
from pipelines.tracking.log import log, note
from pipelines.tracking.waiting import waiting


@pytest.fixture
def beside(monkeypatch):
    """The command itself sends nothing."""
    monkeypatch.setattr("os.cpu_count", lambda: 2)
    monkeypatch.setattr(log_module, "send", lambda *given: pytest.fail("sent by the command itself"))
    with imported_beside():
        yield


def test_the_run_is_sent_and_what_cannot_be_is_kept(settings, heard, beside):
    own = settings()
    assert sends(own)
    assert not sends(settings({"mlflow.tracking_uri": "http://127.0.0.1:9"}))
    assert log(own, lambda: note(own, "one", "fit", 1.0, 2.0, "FINISHED"), heard)
    with closing(sqlite3.connect(own.outputs / "mlflow.db")) as store:
        assert store.execute("select name, status from runs").fetchall() == [("fit", "FINISHED")]

    broken = settings({"paths.outputs": "elsewhere"})
    (broken.outputs / "mlflow.db").parent.mkdir()
    (broken.outputs / "mlflow.db").write_text("no database, for sure" * 99)
    assert log(broken, lambda: note(broken, "two", "fit", 1.0, 2.0, "FINISHED"), heard)
    assert [kept.key for _, kept in waiting(broken)] == ["two"]
    assert "file is not a database" in heard.warned[-1]


def test_it_is_over_with_the_command(settings, monkeypatch):
    monkeypatch.setattr("os.cpu_count", lambda: 1)
    with imported_beside():
        assert not sends(settings())
    assert not sends(settings())
