"""``hybridid cases`` and ``hybridid effects``."""

from __future__ import annotations

from pathlib import Path

import pytest

from hybridid.effects.library import EFFECTS
from hybridid_cli.config_files import user_folders


def test_effects_lists_equation_parameters_units_and_source(say):
    said = say("effects")
    assert said.code == 0
    for effect in EFFECTS:
        block = f"\n{said.out}"[f"\n{said.out}".index(f"\n{effect.id}: ") :].partition("\n\n")[0]
        assert effect.equation in block
        assert all(f"parameter {p.name} [" in block for p in effect.parameters)
        assert effect.source.split()[0] in block
    assert "f_v [N·s/m or " in said.out


def test_one_effect_says_what_tells_it_apart(say):
    said = say("effects", "viscous")
    assert said.code == 0
    assert " ".join(next(e for e in EFFECTS if e.id == "viscous").pattern.split()) in " ".join(
        said.out.split()
    )


def test_misspelt_effect(say):
    said = say("effects", "viscos")
    assert said.code == 2
    assert "did you mean 'viscous'?" in said.complaint


@pytest.fixture(scope="module")
def listed():
    return {}


@pytest.fixture
def cases(say, listed):
    """``cases(*words)``: what ``hybridid cases`` lists, composed once for all tests."""

    def of(*words):
        if words not in listed:
            said = say("cases", *words)
            assert said.code == 0
            assert list(Path().iterdir()) == []
            listed[words] = said.out
        return listed[words]

    return of


def test_cases_without_data_says_simulated(cases):
    said = cases()
    for part in ("emps: ", "force [N]", "position [m]", "viscous@carriage", "simulated", "Janot"):
        assert part in said
    assert "hybridid fetch emps" in said


def test_cases_with_data_says_measured(say, measured):
    said = say("cases", "emps", f"paths.data={measured}")
    assert f"record   identification (identification): measured, {measured}" in said.out
    assert "simulated" not in said.out


def test_cases_say_what_every_port_carries_or_why_it_has_no_load(cases):
    said = cases()
    assert "load     carriage: drive: motor force through screw and nut" in said
    assert "load     motor: drive: motor torque; load: torque of the elastomer on the motor" in said
    assert "load     oscillator: none (an electronic circuit: nothing slides)" in said
    assert "load     front_suspension: none (the spring stands beside the damper;" in said


def test_cases_say_which_law_ran_the_machine(cases, say):
    said = cases().partition("esea: ")[0]
    assert "control  emps_pd: cascaded PD of the EMPS" in said
    assert "follows reference [m], pulses [V]" in said
    assert "kp 160.18 1/s, kv 243.45 V·s/m, gain 35.1507 N/V, limit 10 V" in said
    assert "control  " not in say("cases", "emps", "controller=null").out
    assert cases().count("control  ") == 1, "of EMPS alone"


def test_misspelt_case(say):
    said = say("cases", "emp")
    assert said.code == 2
    assert "did you mean 'emps'?" in said.complaint


def test_effects_of_a_level_have_units_of_flows_and_levels(say):
    said = say("effects", "overflow").out
    assert "acts at   flow ports" in said
    assert "parameter k [m²/s]" in said
    assert "parameter limit [m]" in said


@pytest.mark.parametrize("command", ["cases", "effects"])
def test_a_folder_that_is_not_named_is_not_the_one_where_one_stands(say, command, own_folder):
    """Its Python files would be importable."""
    said = say(command, "--config-dir")
    assert said.code == 2
    assert said.err == "hybridid: --config-dir wants a folder after it\n"
    assert user_folders(["--config-dir"]) == []


def test_one_effect_says_what_it_is_taken_for_and_the_experiment_that_tells(say):
    said = say("effects", "quadratic_drag").out
    for label in ("tells", "alike", "apart by"):
        assert f"\n  {label}" in said
    assert "viscous, coulomb, stribeck" in said
    assert "constant-velocity runs" in said
