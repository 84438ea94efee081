"""``-m``: one command, several runs, one after the other or side by side."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

SWEEP = ("-m", "out=all", "estimator.horizon=150,400")


@pytest.mark.parametrize("launcher", ["local", "joblib"])
def test_each_job_has_its_own_tree_in_out(say, process, quick, launcher):
    """The workers of joblib outlive a command in this process."""
    typed, more = (process, ("hydra.launcher.n_jobs=2",)) if launcher == "joblib" else (say, ())
    said = typed("fit", *quick, *SWEEP, f"launcher={launcher}", *more)
    assert said.code == 0, said.err
    trees = sorted(p for p in Path("all").iterdir() if p.is_dir())
    assert len(trees) == 2
    assert all(tree.name.endswith("-simulated") for tree in trees)
    horizons = {json.loads((t / "fit/estimate.json").read_text())["settings"]["horizon"] for t in trees}
    assert horizons == {150, 400}
    assert sorted(p.name for p in Path().iterdir()) == ["all"]
    assert "#0 [simulated]" in said.out
    assert "#1 [simulated]" in said.out


def test_a_job_that_fails_leaves_the_others(say, quick):
    said = say("fit", *quick, "-m", "out=all", "effects=[viscous,coulomb,offset],[viscos]")
    assert said.code == 2
    assert "did you mean 'viscous'?" in said.complaint
    assert "effects=[viscos]" in said.err, "does not say which job"
    assert len(list(Path("all").glob("*/fit/estimate.json"))) == 1


def test_without_out_trees_lie_under_the_case(say, quick):
    assert say("fit", *quick, "-m", "estimator.horizon=150,400").code == 0
    trees = [p for p in Path("outputs/emps").iterdir() if not p.is_symlink()]
    assert len(trees) == 2
    assert Path("outputs/emps/latest").resolve() in [tree.resolve() for tree in trees]
