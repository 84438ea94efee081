"""The servo from command to scores: its virtual rig, a kind of trajectory left out, the measured twelve."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pyarrow.parquet as parquet
import pytest

LOAD = "effects=[viscous,coulomb,load_friction]"
RIVAL = 33.3  # mrad, the publishers' best model refitted on all twelve


@pytest.fixture
def errors(say):
    """Mean absolute error [mrad] of each record in free run, by name."""

    def validated(*words):
        said = say(
            "validate", "case=servo", "mlflow.enabled=false", "out=tree", "validate.views=[free_run]", *words
        )
        assert said.code == 0, said.err
        found = {}
        for file in Path("tree/validate").glob("*.free_run.parquet"):
            table = parquet.read_table(file).to_pandas()
            measured, predicted = (table[f"position.{side}"] for side in ("measured", "predicted"))
            found[file.name.split(".")[0]] = 1e3 * float(np.abs(measured - predicted).mean())
        return found, said

    return validated


def test_a_kind_of_trajectory_left_out_on_the_rig(errors):
    words = ("data=simulated", "rig.duration=3.0", "fit.records=[sin_sin*,lift_and_drop_kp800]")
    found, said = errors(LOAD, *words, "validate.records=[up_and_down*]")
    assert "simulated" in (said.out + said.err).lower()
    assert set(found) == {f"up_and_down_kp{gain}" for gain in (100, 200, 400, 800)}
    assert max(found.values()) < 10.0, found
    fit = json.loads(Path("tree/fit/estimate.json").read_text())
    assert fit["records"] == [*(f"sin_sin_kp{gain}" for gain in (100, 200, 400, 800)), "lift_and_drop_kp800"]


def test_a_pattern_that_fits_no_record_is_one_line(say):
    said = say("fit", "case=servo", "data=simulated", "mlflow.enabled=false", "fit.records=[cos*]")
    assert said.code != 0
    assert "cos*" in said.complaint


def test_load_friction_predicts_the_measured_twelve_better_than_the_rival(errors, measured):
    if not (measured / "bam_xl330").is_dir():
        pytest.skip(f"{measured} does not hold bam_xl330")
    every = "fit.records=[identification,validation]"
    plain, said = errors(every, f"paths.data={measured}")
    assert "simulated" not in said.out + said.err
    assert len(plain) == 12
    found, _ = errors(LOAD, every, f"paths.data={measured}")
    assert np.mean(list(found.values())) < RIVAL
    assert np.mean(list(found.values())) < 0.8 * np.mean(list(plain.values()))
