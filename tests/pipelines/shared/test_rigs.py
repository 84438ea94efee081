"""What ``rig:`` in a config makes of a virtual rig, and what a mistake in it costs: one line."""

from __future__ import annotations

import numpy as np
import pytest

from hybridid.rigs.emps import EMPSRig
from hybridid.rigs.esea import AS_DECLARED_LUGRE
from pipelines.shared.errors import ConfigError
from pipelines.shared.rigs import rig_of
from pipelines.shared.sources import sources_of

EMPS = {"path": "hybridid.rigs.emps:EMPSRig"}
ESEA = {"path": "hybridid.rigs.esea:ESEARig"}


def test_a_class_makes_a_rig_and_an_instance_is_one():
    assert (
        rig_of({**EMPS, "seed": 0, "duration": None, "truth": None, "planted": None}).digest()
        == EMPSRig().digest()
    )
    assert rig_of({"path": "hybridid.rigs.esea:AS_DECLARED_LUGRE"}) is AS_DECLARED_LUGRE


def test_the_truth_is_as_the_config_says():
    rig = rig_of(
        {
            **ESEA,
            "truth": {"K_e": 9, "torque_gain": 1.0},
            "planted": [{"law": "viscous", "port": "link", "f_v": 0.1}],
        }
    )
    assert "K_e 9 N m/rad" in rig.summary()
    assert rig.summary().endswith("planted: viscous at link (f_v 0.1 N m s/rad)")
    assert rig_of({**ESEA, "planted": []}).summary().endswith("planted: nothing")


def test_a_planted_effect_reaches_the_records_and_their_digests(settings, own_folder):
    rig = {**EMPS, "seed": 0, "duration": 1.2}
    planted = [{"law": "quadratic_drag", "c": 400.0}]
    plain, told = (
        sources_of(settings({"data": "simulated", "rig": {**rig, "planted": p}})).found[0]
        for p in (None, planted)
    )
    assert plain.digest != told.digest
    assert "quadratic_drag at carriage (c 400" in told.record().source
    assert not np.array_equal(plain.record().outputs, told.record().outputs)


@pytest.mark.parametrize(
    ("given", "line"),
    [
        (
            "hybridid.rigs.emps:EMPSRig",
            "rig is 'hybridid.rigs.emps:EMPSRig': give path, seed, duration, truth",
        ),
        ({**EMPS, "thruth": {}}, "unknown config key below rig 'thruth'"),
        ({"path": "hybridid.rigs.emps:DEFAULT"}, "is a EMPSConfig, not a hybridid.rigs.rig.Rig"),
        ({**EMPS, "truth": {"m": 90.0}}, "rig.truth: unknown value 'm': did you mean 'M'"),
        ({**EMPS, "truth": {"M": -1.0}}, "rig.truth: EMPS rig: M is -1 kg"),
        (
            {**EMPS, "planted": [{"law": "stribek"}]},
            r"rig.planted\[0\]: no law 'stribek' to plant; nearest: stribeck",
        ),
        ({**ESEA, "planted": [{"law": "viscous", "port": "motr", "f_v": 1.0}]}, "unknown port 'motr'"),
    ],
)
def test_a_mistake_costs_one_line(given, line):
    with pytest.raises(ConfigError, match=line) as refused:
        rig_of(given)
    assert "\n" not in str(refused.value)
