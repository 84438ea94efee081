"""Advice on measured records: no false alarm, and the one that their publishers' servo needs."""

from __future__ import annotations

import json
from pathlib import Path

import pytest


@pytest.fixture
def advice(say, measured):
    """What ``hybridid fit`` advises on measured records, by kind."""

    def of(case, folder, *words):
        if not (measured / folder).is_dir():
            pytest.skip(f"{measured} does not hold {folder}")
        said = say(
            "fit", f"case={case}", f"paths.data={measured}", "mlflow.enabled=false", "out=tree", *words
        )
        assert said.code == 0, said.err
        found = json.loads(Path("tree/fit/estimate.json").read_text())["quality"]["advice"]
        assert all(said.out.count(one["said"]) == 1 for one in found)
        return {one["kind"]: one["said"] for one in found}

    return of


@pytest.mark.parametrize("horizon", ["estimator.horizon=null", "estimator.horizon=1000"])
def test_emps_is_told_of_its_pulses_alone(advice, horizon):
    found = advice("emps", "emps", horizon)
    assert found.keys() == {"range"}
    assert found["range"].startswith(
        "record validation leaves what was fitted: force −230 to 217 N, fitted −151 to 145 N; "
    )


@pytest.mark.parametrize("effects", ["effects=[]", "effects=[cubic_stiffness]"])
def test_silverbox_is_told_of_its_arrow_alone(advice, effects):
    found = advice("silverbox", "silverbox", effects)
    assert found.keys() == {"range"}
    assert found["range"].startswith("record arrow leaves what was fitted: V2 ")


@pytest.mark.parametrize("effects", ["effects=[viscous,coulomb]", "effects=[viscous,coulomb,load_friction]"])
def test_the_servo_is_told_nothing(advice, effects):
    assert advice("servo", "bam_xl330", effects) == {}


def test_the_flexible_link_is_told_of_its_sensors_alone(advice):
    """An encoder, and a strain gauge."""
    found = advice("flexible_link", "quanser_flexible_link")
    assert found.keys() == {"weights"}
    assert found["weights"].startswith("servo_angle is measured 17 times as well as tip_angle")


def test_the_resistance_of_the_servo_is_told_with_its_torque_constant(advice):
    found = advice("servo", "bam_xl330", "parameters.R.lower=2", "parameters.R.upper=4")
    assert found.keys() == {"bound"}
    assert found["bound"].startswith("R is at its bound and collinear with k_t (correlation of size 0.99")
