"""``hybridid reproduce`` as it is typed: exit codes, and what is said where."""

from __future__ import annotations

from pathlib import Path

import pytest

SHORT = ("data=simulated", "rig.duration=1.2", "mlflow.enabled=false", "processes=1", "estimator.horizon=300")


def test_the_page_is_named_on_stdout(say):
    said = say("reproduce", "experiments=[emps_free_run]", *SHORT)
    assert said.code == 0
    assert said.out == "page: outputs/thesis/index.html\n"
    assert "1 of 1 emps_free_run: done in" in said.err
    assert "simulated" in Path("outputs/thesis/index.md").read_text()


def test_a_failure_exits_non_zero_and_names_experiment_and_page(say):
    said = say("reproduce", "experiments=[emps_free_run]", "parameters.M.lower=200", *SHORT)
    assert said.code == 1
    assert said.complaint.startswith("hybridid: 1 of 1 experiments failed: emps_free_run (")
    assert said.complaint.endswith("the page shows the others: outputs/thesis/index.html")
    assert "failed: " in Path("outputs/thesis/index.md").read_text()


@pytest.mark.parametrize(
    ("word", "line"),
    [("experiments=3", "experiments[0] is 3: expected text"), ("processes=0", "processes is 0: at least 1")],
)
def test_a_wrong_key_is_one_line(say, word, line):
    said = say("reproduce", *SHORT, word)
    assert said.code == 2
    assert line in said.complaint


def test_an_unknown_experiment_is_a_wrong_request(say):
    said = say("reproduce", "experiments=[emps_free_rum]", *SHORT)
    assert said.code == 2
    assert "emps_free_rum" in said.complaint
    assert "emps_free_run" in said.complaint
    assert not Path("outputs/thesis").exists()
