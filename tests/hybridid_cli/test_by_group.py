"""``parameters.NAME.by`` as it is typed, and what the terminal says of the difference. The rig stands in."""

from __future__ import annotations

import json

import pytest

F_C = "carriage.coulomb.f_c"
SIMULATED = (
    "case=emps",
    "data=simulated",
    "rig.duration=4",
    "estimator.horizon=500",
    "mlflow.enabled=false",
    "out=tree",
)


def test_each_value_and_whether_they_differ_are_said(say, own_folder):
    """Both records come from one carriage, so nothing differs."""
    said = say("fit", *SIMULATED, f"parameters.{F_C}.by=record", "fit.records=null")
    assert said.code == 0, said.complaint
    for record in ("identification", "validation"):
        assert f" {F_C}[{record}] " in said.out
    (line,) = (line for line in said.out.splitlines() if line.startswith(F_C))
    assert line.startswith(f"{F_C} does not differ noticeably by recording: ")
    found = json.loads((own_folder / "tree/fit/estimate.json").read_text())["differences"][F_C]
    assert found["p_value"] > 0.05
    assert f"(chi-square {found['chi_square']:.3g} with 1)" in line


@pytest.mark.parametrize(
    ("words", "line"),
    [
        ([f"parameters.{F_C}.by=record"], "identification is the only group, so nothing can differ"),
        (
            [f"parameters.{F_C}.by={{cold: [identification], warm: [validaton]}}", "fit.records=null"],
            "did you mean 'validation'?",
        ),
    ],
)
def test_a_wrong_group_is_one_line(say, own_folder, words, line):
    said = say("fit", *SIMULATED, *words)
    assert said.code != 0
    assert line in said.complaint
    assert not (own_folder / "tree").exists()


def test_without_groups_nothing_is_said_of_them(say, own_folder):
    said = say("fit", *SIMULATED)
    assert said.code == 0, said.complaint
    assert "by recording" not in said.out
    assert json.loads((own_folder / "tree/fit/estimate.json").read_text())["differences"] == {}
