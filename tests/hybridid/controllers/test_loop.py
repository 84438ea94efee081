"""A controller as it is declared and set up: names, units, numbers; what is wrong is told in one line."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest

from hybridid.blame import OwnCodeError
from hybridid.controllers.controller import Controller, Reference
from hybridid.controllers.emps_pd import EMPSPD
from hybridid.controllers.loop import Loop
from hybridid.declarations import Parameter, Signal
from hybridid.plants.duffing import Duffing
from hybridid.plants.emps import EMPS
from hybridid.rigs.emps import EMPSRig

PLANT = EMPS()


@pytest.fixture(scope="module")
def record():
    return EMPSRig().record("validation", duration=1.2)


def test_the_law_takes_its_own_numbers_and_those_given(record):
    plain, given = Loop(EMPSPD()), Loop(EMPSPD(), {"kp": 150.0}, every=2, delay=3)
    np.testing.assert_allclose(plain.parameters(1e-3), [160.18, 243.45, 35.15065188, 10.0, 1e-3])
    np.testing.assert_allclose(given.parameters(1e-3), [150.0, 243.45, 35.15065188, 10.0, 2e-3])
    assert (plain.settled, given.settled) == (2, 2 * 2 + 3)
    plain.check(PLANT.inputs, PLANT.outputs)
    np.testing.assert_array_equal(plain.followed(record), record.auxiliary)


def test_an_optional_reference_is_zero_where_the_record_lacks_it(record):
    bare = replace(
        record, auxiliary=record.auxiliary[:, :1], auxiliary_channels=record.auxiliary_channels[:1]
    )
    assert record.signal("pulses").max() == 5.0
    followed = Loop(EMPSPD()).followed(bare)
    np.testing.assert_array_equal(followed[:, 0], record.signal("reference"))
    assert not followed[:, 1].any()
    with pytest.raises(
        ValueError, match="has no signal pulses, which is its pulses; it has force, position and"
    ):
        Loop(EMPSPD(), references={"pulses": "pulses"}).followed(bare)


@pytest.mark.parametrize(
    ("wrong", "line"),
    [
        ({"values": {"kq": 1.0}}, "unknown parameter of controller emps_pd: 'kq': did you mean"),
        ({"values": {"limit": -1.0}}, "controller emps_pd: limit is -1, must lie in [0, inf] V"),
        ({"references": {"goal": "reference"}}, "unknown reference of controller emps_pd: 'goal'"),
    ],
)
def test_what_the_law_does_not_know_is_refused(wrong, line):
    with pytest.raises(ValueError, match=re.escape(line)):
        Loop(EMPSPD(), **wrong)


def test_a_record_in_another_unit_is_refused(record):
    loop = Loop(EMPSPD(), references={"reference": "force"})
    with pytest.raises(ValueError, match="reference is in m, record emps_rig_validation has force in N"):
        loop.followed(record)


def test_a_plant_without_the_signals_is_refused():
    duffing = Duffing()
    with pytest.raises(ValueError, match="unknown input of controller emps_pd: 'force'"):
        Loop(EMPSPD()).check(duffing.inputs, duffing.outputs)
    with pytest.raises(ValueError, match="input force is in N, the plant has it in kN"):
        Loop(EMPSPD()).check((Signal("force", "kN"),), PLANT.outputs)


def test_a_law_may_not_call_a_parameter_dt():
    class Odd(Controller):
        name, meaning, source = "odd", "", ""
        references = (Reference("reference", "m"),)
        outputs, commands = PLANT.outputs, PLANT.inputs
        parameters = (Parameter("dt", "s", guess=1.0),)

        def command(self, reference, outputs, state, p):
            return {"force": p.dt}

    with pytest.raises(ValueError, match="dt is its sampling time, and no name of a parameter"):
        Loop(Odd())


@pytest.mark.parametrize(
    ("what", "value", "line"),
    [
        ("outputs", None, "outputs is missing, expected a tuple, as in outputs = (Signal(...),)"),
        ("commands", Signal("force", "N"), "commands is a Signal, expected a tuple"),
        (
            "references",
            (Signal("reference", "m"),),
            "references holds a Signal, expected Reference(...) alone",
        ),
        ("delay", 0.5, "delay is no whole number of samples"),
    ],
)
def test_a_declaration_that_is_wrong_is_told_with_its_file(what, value, line):
    class Odd(Controller):
        name, meaning, source = "odd", "", ""
        references = (Reference("reference", "m"),)
        outputs, commands, parameters = PLANT.outputs, PLANT.inputs, ()

        def command(self, reference, outputs, state, p):
            return {"force": 0.0}

    setattr(Odd, what, value)
    with pytest.raises(OwnCodeError, match=re.escape(line)) as caught:
        Loop(Odd())
    assert str(caught.value).startswith("test_loop.py, line ")
