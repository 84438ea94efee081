"""MLflow: what a run holds, that many processes may begin at once, and that a result outlives it."""

from __future__ import annotations

import os
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import pytest

from pipelines.runner import run_stages
from pipelines.shared.errors import ConfigError
from pipelines.tracking.note import KEY, Metric, Note
from pipelines.tracking.runs import client, tracked, tracking_uri
from pipelines.tracking.send import send
from pipelines.tracking.waiting import waiting

ROOT = Path(__file__).parents[3]


def logged(settings, command, heard):
    with tracked(settings, command, heard) as run:
        outcome = run_stages(settings, command, heard)
        run.finish(outcome)
    store = client(settings)
    experiment = store.get_experiment_by_name("short")
    return store, store.search_runs([experiment.experiment_id])[0], outcome


def commit() -> dict[str, str]:
    """The tag that names the checkout's commit; none outside a checkout."""
    done = subprocess.run(["git", "-C", str(ROOT), "rev-parse", "HEAD"], capture_output=True, text=True)
    return {} if done.returncode else {"mlflow.source.git.commit": done.stdout.strip()}


def test_a_run_holds_all_that_is_known_of_it(settings, heard, data):
    store, run, outcome = logged(settings(), "validate", heard)
    assert run.info.status == "FINISHED"
    assert run.info.run_name == "validate"
    assert run.data.params["estimator.horizon"] == "300"
    assert run.data.params["effects"] == "['viscous', 'coulomb', 'offset']"
    assert run.data.metrics["parameter.M"] == pytest.approx(95, rel=0.05)
    assert run.data.metrics["second.position.horizon.rmse"] > 0
    costs = store.get_metric_history(run.info.run_id, "cost")
    assert len(costs) >= 2
    assert costs[-1].value <= costs[0].value
    tags = run.data.tags
    assert tags["provenance"] == "measured"
    assert len(tags["data.first"]) == 64
    assert tags["stages.ran"] == "preprocess, fit, validate"
    assert tags["tree"] == str(outcome.tree.resolve())
    assert tags["fit.converged"] == "true"
    assert {key: tags[key] for key in commit()} == commit()
    kept = {f.path for f in store.list_artifacts(run.info.run_id)}
    assert kept == {"config.yaml", "fit", "validate"}
    assert (Path("outputs/mlflow-artifacts/short") / run.info.run_id / "artifacts/fit/estimate.json").exists()
    assert sorted(p.name for p in Path("outputs").iterdir() if not p.name.startswith(".")) == [
        "mlflow-artifacts", "mlflow.db", "short"
    ]  # fmt: skip


def test_failed_command_is_a_failed_run(settings, heard, data):
    with pytest.raises(RuntimeError), tracked(settings(), "fit", heard):
        raise RuntimeError("the solver\nbroke")
    store = client(settings())
    run = store.search_runs([store.get_experiment_by_name("short").experiment_id])[0]
    assert run.info.status == "FAILED"
    assert run.data.tags["error"] == "RuntimeError: the solver broke"


@pytest.mark.parametrize("error", [ConfigError("wrong"), KeyboardInterrupt()])
def test_wrong_or_interrupted_request_is_no_run(settings, heard, error):
    with pytest.raises(type(error)), tracked(settings(), "fit", heard):
        raise error
    assert not Path("outputs").exists()


@pytest.mark.parametrize("patience", ["long", -1, True])
def test_patience_that_is_no_time_is_said_before_anything_is_done(settings, heard, patience):
    with (
        pytest.raises(ConfigError, match=r"mlflow\.patience"),
        tracked(settings({"mlflow.patience": patience}), "fit", heard),
    ):
        pytest.fail("it began")


def test_switched_off(settings, heard, data):
    off = settings({"mlflow.enabled": False})
    with tracked(off, "preprocess", heard) as run:
        run.finish(run_stages(off, "preprocess", heard))
    assert [p.name for p in Path("outputs").iterdir()] == ["short"]


def test_broken_store_costs_one_line_and_no_result(settings, heard, data):
    Path("outputs").mkdir()
    Path("outputs/mlflow.db").write_text("this is no database, but it is long enough to be read as one" * 20)
    with tracked(settings(), "fit", heard) as run:
        outcome = run_stages(settings(), "fit", heard)
        run.finish(outcome)
    assert (outcome.tree / "fit" / "estimate.json").exists()
    (warning,) = heard.warned
    assert warning.startswith("not logged to MLflow")
    assert "hybridid log" in warning
    assert "\n" not in warning
    ((place, note),) = waiting(settings())
    assert note.name == "fit"
    assert (place / "files" / "1" / "fit" / "estimate.json").exists()


def test_where_the_store_is(settings):
    assert tracking_uri(settings()) == f"sqlite:///{Path.cwd()}/outputs/mlflow.db"
    assert tracking_uri(settings({"mlflow.tracking_uri": "http://server:80"})) == "http://server:80"


BEGIN = """
import os, sys
import mlflow.store.tracking.sqlalchemy_store, mlflow.tracking
from sqlalchemy.orm import configure_mappers
from pipelines.shared.config import Settings
from pipelines.tracking.runs import Point, log_point

class Heard:
    def say(self, line): print(line)
    def warn(self, line): print("WARNED", line)
    def carry_on(self): pass
    def progress(self, *report): pass

def job(number):
    settings = Settings("short", {"paths": {"outputs": "outputs"}, "mlflow": {"enabled": True}})
    point = Point(f"point {number}", "fit", {}, {}, 0.0, 1.0, error=f"job {number}")
    log_point(settings, point, "sweep", Heard())

configure_mappers()  # once, not in each process
wait, begin = os.pipe()
for number in range(4):
    if os.fork() == 0:
        os.close(begin)
        os.read(wait, 1)  # all begin when the parent closes its end
        job(number)
        sys.stdout.flush()
        os._exit(0)  # to tear down an interpreter with MLflow in it takes as long as to begin the run
os.close(begin)
sys.exit(max(os.wait()[1] for _ in range(4)))
"""


def test_four_processes_begin_at_once_on_a_store_that_is_not_there(settings, monkeypatch):
    """Whoever is first makes database, experiment and the sweep's run; none dies of the others."""
    monkeypatch.setenv("PYTHONPATH", str(ROOT))
    done = subprocess.run([sys.executable, "-c", BEGIN], capture_output=True, text=True, timeout=240)
    assert done.returncode == 0, done.stderr
    assert "WARNED" not in done.stdout, done.stdout
    store = client(settings())
    runs = store.search_runs([store.get_experiment_by_name("short").experiment_id])
    (sweep,) = [run for run in runs if run.data.tags[KEY] == "sweep"]
    runs.remove(sweep)
    assert {run.data.tags["mlflow.parentRunId"] for run in runs} == {sweep.info.run_id}
    said = sorted(run.data.tags["error"] for run in runs)
    assert said == sorted(f"job {k}" for k in range(4))


def test_nothing_is_sent_to_mlflows_maker(settings, monkeypatch):
    for name in ("MLFLOW_DISABLE_TELEMETRY", "DO_NOT_TRACK"):
        monkeypatch.delenv(name, raising=False)
    client(settings())
    assert os.environ["MLFLOW_DISABLE_TELEMETRY"] == "true"
    assert os.environ["DO_NOT_TRACK"] == "true"


@pytest.mark.parametrize(("status", "ended"), [("FAILED", 1000), ("RUNNING", None)])
def test_a_note_that_waited_undoes_nothing_of_a_later_one(settings, status, ended):
    """The first attempt failed and waited; the second was sent, and then ``hybridid log`` sent the first."""
    own = settings()
    note = Note("one", "fit", "short", None, 500, 2000, "FINISHED", metrics=(Metric("cost", 1.0),))
    late = replace(
        note, ended=ended, status=status, metrics=(Metric("cost", 9.0), Metric("n", 3.0)),
        tags={"error": "full disk", "tree": "here"}, params={"effects": "[]"},
    )  # fmt: skip
    for given in (note, late):
        send(given, own)
    store = client(own)
    (run,) = store.search_runs([store.get_experiment_by_name("short").experiment_id])
    assert (run.info.status, run.info.end_time) == ("FINISHED", 2000)
    assert "error" not in run.data.tags
    assert run.data.metrics == {"cost": 1.0, "n": 3.0}
    assert (run.data.tags["tree"], run.data.params) == ("here", {"effects": "[]"})
    send(replace(late, ended=3000, status="FAILED"), own)
    assert store.get_run(run.info.run_id).info.status == "FAILED", "the last word counts"
