"""What a config may say of a rig's truth: numbers by name and laws at ports, and mistakes in one line."""

from __future__ import annotations

import pytest

from hybridid.rigs.emps import DEFAULT, EMPSRig
from hybridid.rigs.esea import ESEARig, ESEATruth
from hybridid.rigs.half_car import HalfCarRig
from hybridid.rigs.law_library import plant
from hybridid.rigs.laws import RigError
from hybridid.rigs.truth import PlantedAt, at, planted_laws, revised

RIGS = (EMPSRig(), ESEARig(), HalfCarRig())
by_name = pytest.mark.parametrize("rig", RIGS, ids=lambda rig: rig.name)


def test_laws_are_planted_at_their_ports():
    entries = [
        {"law": "stribeck", "port": "motor", "amplitude": 0.02, "velocity": 1},
        {"law": "offset", "port": "link", "offset": 0.1},
    ]
    stribeck, offset = planted_laws(entries, ESEARig.ports)
    assert stribeck == at("motor", "stribeck", amplitude=0.02, velocity=1.0)
    assert offset == PlantedAt("link", plant("offset", offset=0.1))


def test_the_port_may_be_left_out_where_there_is_one():
    (viscous,) = planted_laws([{"law": "viscous", "f_v": 3.0}], EMPSRig.ports)
    assert viscous.port == "carriage"
    with pytest.raises(
        RigError, match=r"rig.planted\[0\]: unknown port 'None': allowed: motor, elastomer, link"
    ):
        planted_laws([{"law": "viscous", "f_v": 3.0}], ESEARig.ports)


@by_name
def test_another_truth_makes_another_rig_and_leaves_the_first(rig):
    planted = planted_laws([{"law": "viscous", "port": rig.ports[0], "f_v": 1.0}], rig.ports)
    name, value = {"emps": ("M", 90.0), "esea": ("K_e", 9.0), "half_car": ("m_c", 1300.0)}[rig.name]
    before = rig.digest()
    told = rig.with_truth({name: value}, planted)
    assert getattr(told.config.truth, name) == value
    assert "viscous" in told.summary()
    assert len(told.config.truth.planted) == 1
    assert rig.digest() == before
    assert (
        len({before, told.digest(), rig.with_truth({name: value}).digest(), rig.with_truth({}, ()).digest()})
        == 4
    )
    assert rig.with_truth({}).digest() == before


def test_the_emps_keeps_what_is_planted_unless_told():
    assert EMPSRig().with_truth({"M": 90.0}).config.truth.planted == DEFAULT.truth.planted
    assert EMPSRig().with_truth({}, ()).config.truth.planted == ()


def test_a_machine_that_turns_has_turning_units():
    assert at("motor", "stribeck", amplitude=0.02, velocity=1.0).said(turns=True) == (
        "stribeck at motor (amplitude 0.02 N m, velocity 1 rad/s)"
    )
    assert at("link", "viscous", f_v=2.0).said(turns=True) == "viscous at link (f_v 2 N m s/rad)"
    assert at("link", "viscous", f_v=2.0).said() == "viscous at link (f_v 2 N s/m)"
    assert "mass 1 kg m^2, frequency 5 Hz" in at(
        "link", "flexible_mode", mass=1, frequency=5, damping=0
    ).said(True)


@pytest.mark.parametrize(
    ("make", "said"),
    [
        (lambda: planted_laws("viscous", ESEARig.ports), "rig.planted is 'viscous': give a list, as in"),
        (lambda: planted_laws(["viscous"], ESEARig.ports), r"rig.planted\[0\] is 'viscous': give a law"),
        (lambda: planted_laws([{"port": "motor"}], ESEARig.ports), "give a law, its port and its values"),
        (
            lambda: planted_laws([{"law": "viscous", "port": "moter", "f_v": 1.0}], ESEARig.ports),
            r"rig.planted\[0\]: unknown port 'moter': did you mean 'motor'",
        ),
        (
            lambda: planted_laws([{"law": "dahll", "port": "link"}], ESEARig.ports),
            r"rig.planted\[0\]: no law 'dahll' to plant; nearest: dahl",
        ),
        (
            lambda: planted_laws([{"law": "viscous", "port": "link", "fv": 1.0}], ESEARig.ports),
            "no parameter 'fv'; nearest: f_v",
        ),
        (
            lambda: planted_laws([{"law": "viscous", "port": "link", "f_v": "much"}], ESEARig.ports),
            "f_v is 'much': expected a number",
        ),
        (lambda: revised(ESEATruth(), 3.0), "rig.truth is 3.0: give values by name, of I, J, K_e"),
        (lambda: revised(ESEATruth(), {"planted": []}), "rig.truth: unknown value 'planted'"),
        (lambda: revised(ESEATruth(), {"I": True}), "rig.truth: I is True: expected a number"),
        (lambda: revised(ESEATruth(), {"I": -1.0}), "rig.truth: eSEA rig: I is -1"),
    ],
)
def test_a_mistake_costs_one_line(make, said):
    with pytest.raises(RigError, match=said) as refused:
        make()
    assert "\n" not in str(refused.value)
