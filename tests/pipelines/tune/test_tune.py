"""The search from config to report: what it asks for, finds, keeps and logs."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest
import yaml
from optuna import TrialPruned

from hybridid.estimators.estimate import Progress
from hybridid_cli.tune_results import shortfall, tune_results
from pipelines.runner import run_stages
from pipelines.shared.errors import ConfigError
from pipelines.shared.storage import read_json
from pipelines.tracking.note import KEY
from pipelines.tracking.runs import client
from pipelines.tune import conduct, trial, worker
from pipelines.tune.conduct import tune
from pipelines.tune.request import TuneRequest

NARX = {
    "kind": "narx", "orders": {"error": 2, "inputs": 1, "gray": 1}, "depth": 1, "width": 4, "seeds": [0],
    "every": 5, "horizons": [1], "epochs": 6, "patience": 6, "learning_rate": 5.0e-3,
}  # fmt: skip
SPACE = {"residual": {"width": {"low": 4, "high": 8}, "orders": {"error": {"low": 1, "high": 3}}}}


@pytest.fixture
def asked(settings, data):
    """``asked(trials=3)``: the settings of a small search."""

    def made(residual=NARX, space=SPACE, **section):
        asked_for = {"space": space, "trials": 3, "startup": 2, **section}
        return settings({"residual": residual, "tune": asked_for})

    return made


@pytest.fixture
def in_this_process(monkeypatch):
    """Workers without processes of their own."""
    monkeypatch.setattr(
        conduct,
        "side_by_side",
        lambda work, names, n, watcher: ((k, work(g, watcher(k))) for k, g in names.items()),
    )


@pytest.mark.parametrize(
    ("section", "says"),
    [
        ({"space": {}}, "tune.space is empty"),
        ({"space": {"residual": {"widht": {"low": 1, "high": 2}}}}, "did you mean 'residual.width'?"),
        ({"space": {"residual": {"seeds": {"low": 1, "high": 2}}}}, "residual.seeds"),
        ({"space": {"residual": {"width": {"low": 8, "high": 4}}}}, "low must be below high"),
        ({"space": {"residual": {"width": {"low": 0, "high": 4, "log": True}}}}, "low must be positive"),
        ({"space": {"residual": {"width": {"low": 1}}}}, "tune.space.residual.width.high is None"),
        ({"space": {"residual": {"width": {"low": 1, "hihg": 4}}}}, "did you mean 'high'?"),
        ({"space": {"residual": {"width": 4}}}, "tune.space.residual.width is 4"),
        ({"space": {"residual": {"width": [4]}}}, "at least two values"),
        ({"space": {"residual": {"depth": {"low": 0, "high": 3}}}}, "residual.depth is 0: at least 1"),
        ({"trials": 0}, "tune.trials is 0"),
        ({"trails": 5}, "did you mean 'trials'?"),
        ({"pruner": "medain"}, "did you mean 'median'?"),
        ({"seconds": -1}, "tune.seconds is -1"),
        ({"residual": {**NARX, "depth": [1, 2]}}, "residual.depth is [1, 2]: one number"),
        ({"residual": {"kind": "rbf", "nodes": [4]}}, "choose residual=narx"),
        ({"residual": None}, "choose residual=narx"),
    ],
)
def test_wrong_requests_are_one_line_before_anything_is_done(asked, heard, section, says):
    with pytest.raises(ConfigError) as error:
        tune(asked(**section), heard)
    assert says in str(error.value)
    assert "\n" not in str(error.value)
    assert not Path("outputs").exists()


def test_values_reach_the_networks_and_the_chosen_config_makes_them_again(
    asked, heard, in_this_process, fits_schema
):
    settings = asked(processes=1)
    tuned = tune(settings, heard)
    assert [row.state for row in tuned.findings.rows].count("running") == 0
    fits_schema(tuned.folder / "tune.json")
    chosen = tuned.findings.chosen
    assert chosen.outputs["position"].held_out == pytest.approx(
        chosen.share * chosen.outputs["position"].without
    )
    kept = yaml.safe_load((tuned.folder / "experiment/tuned.yaml").read_text())
    defaults = kept.pop("defaults")
    assert {"override /case": "short"} in defaults
    assert kept["residual"]["width"] == chosen.values["residual.width"]
    again = run_stages(replace(settings, config={**settings.config, **kept}), "residual", heard)
    (row,) = read_json(again.tree / "residual/residual.json")["networks"]
    assert row["held_out"] == chosen.outputs["position"].held_out
    assert row["weights"] == chosen.weights

    shown = tune_results(tuned)
    assert f"chosen: trial {chosen.number}" in shown
    assert "measured" in shown
    assert "experiment=tuned" in shown
    assert shortfall(tuned) == ""
    assert "Objective" in (tuned.folder / "index.html").read_text()
    assert "history.svg" in (tuned.folder / "index.md").read_text()

    more = tune(asked(processes=1, trials=4), heard)
    assert more.folder == tuned.folder
    assert "continues a search: 3 of 4 trials are done" in " ".join(heard.said)
    assert more.findings.rows[:3] == tuned.findings.rows
    store = client(settings)
    runs = store.search_runs([store.get_experiment_by_name("short").experiment_id])
    by_key = {run.data.tags[KEY]: run for run in runs}
    assert len(by_key) == len(runs) == 5
    (parent,) = [run for run in runs if "mlflow.parentRunId" not in run.data.tags]
    children = [run for run in runs if run is not parent]
    assert {run.data.tags["mlflow.parentRunId"] for run in children} == {parent.info.run_id}
    assert parent.info.status == "FINISHED"


def test_another_search_does_not_take_its_folder(asked, heard, in_this_process):
    settings = asked(processes=1, trials=1)
    there = replace(settings, config={**settings.config, "out": "search"})
    tune(there, heard)
    wider = {"residual": {"width": {"low": 4, "high": 9}}}
    other = {**asked(space=wider, processes=1, trials=1).config, "out": "search"}
    with pytest.raises(ConfigError, match="search holds the search"):
        tune(replace(settings, config=other), heard)


def test_a_trial_that_fails_is_named_and_the_others_go_on(asked, heard, in_this_process, monkeypatch):
    whole = worker.carried_out

    def broken(bench, values, its_trial, name, watcher):
        if its_trial.number == 1:
            raise ValueError("no such network")
        return whole(bench, values, its_trial, name, watcher)

    monkeypatch.setattr(worker, "carried_out", broken)
    tuned = tune(asked(processes=1), heard)
    assert [row.state for row in tuned.findings.rows][1] == "failed"
    assert tuned.findings.chosen is not None
    assert "trial 1 (" in shortfall(tuned)
    assert "ValueError: no such network" in shortfall(tuned)
    assert "no such network" in (tuned.folder / "index.html").read_text()


def test_a_trial_is_told_to_end(heard):
    class Hopeless:
        def report(self, value, step):
            self.seen = (value, step)

        def should_prune(self):
            return self.seen[1] >= 30

    its_trial = Hopeless()
    report = trial._reporter(its_trial, "trial 3", heard)
    report(Progress("network", 20, 0.25, 0.2))
    assert its_trial.seen == (0.5, 20)
    report(Progress("network", 21, 0.25, 0.21))
    assert its_trial.seen == (0.5, 20), "the journal is not filled with every epoch"
    with pytest.raises(TrialPruned, match="at 30 %"):
        report(Progress("network", 30, 0.16, 0.3))


def test_a_number_or_a_choice(asked):
    space = {"residual": {"increment": [True, False], "batch": {"low": 64, "high": 256, "step": 64}}}
    request = TuneRequest.of(asked({**NARX, "increment": False, "batch": 64}, space))
    assert [list(corner.values()) for corner in request.corners()] == [[True, 64], [False, 256]]
    assert request.distributions()["residual.batch"].step == 64
