"""The verdict on a fit as it is typed: said before any number, and by the exit code. The rig stands in."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

WORDS = ("case=emps", "data=simulated", "rig.duration=4", "mlflow.enabled=false", "out=tree")


def fit_file() -> dict:
    return json.loads(Path("tree/fit/estimate.json").read_text())


@pytest.mark.usefixtures("own_folder")
def test_a_sound_fit_says_so_before_its_numbers_and_ends_with_0(say):
    said = say("fit", *WORDS, "estimator.horizon=500")
    assert said.code == 0, said.err
    assert said.out.index("Fit quality (simulated): sound") < said.out.index("Estimates from")
    assert "doing nothing" in said.out
    assert fit_file()["quality"]["verdict"] == "sound"


@pytest.mark.usefixtures("own_folder")
def test_a_fit_that_has_not_converged_ends_with_3_and_states_no_error(say):
    said = say("fit", *WORDS, "estimator.max_iterations=1")
    assert said.code == 3
    assert "NOT CONVERGED" in said.out
    assert "not converged" in said.err
    assert all(p["std"] is None for p in fit_file()["parameters"].values())


@pytest.mark.usefixtures("own_folder")
def test_a_wrong_model_ends_with_4_after_all_stages(say):
    """Friction and mass that no such carriage has: the record asks for others, outside the bounds."""
    bounds = (
        "parameters.M.lower=900",
        "parameters.M.upper=1000",
        "parameters.carriage.coulomb.f_c.fixed=500",
    )
    said = say("validate", *WORDS, *bounds)
    assert said.code == 4, said.err
    assert "the results are in tree" in said.err
    assert Path("tree/validate/metrics.json").exists()


def test_the_codes_are_in_the_help(say):
    said = say("fit", "--help").out
    assert "3 if the fit has not converged" in said
    assert "4 if the model is wrong" in said
