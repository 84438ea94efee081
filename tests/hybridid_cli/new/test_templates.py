"""The templates, and what ``new`` makes of them; ``test_page.py`` fits and traces each."""

from __future__ import annotations

import json

import numpy as np
import pytest
import yaml

from hybridid.model import compose
from pipelines.new.template import kinds, template


@pytest.mark.parametrize("kind", kinds())
def test_a_template_describes_its_plant(kind):
    plan = template(kind)
    assert plan.about.signals.keys() == {signal.name for signal in (*plan.inputs, *plan.outputs)}
    assert plan.about.derivatives.keys() == {signal.name for signal, _ in plan.made}
    assert plan.plant.name == kind
    for name, scale in plan.about.scales.items():
        assert f"\n{name} = " in plan.source
        assert {scale.of, scale.less or scale.of} <= plan.about.signals.keys()
    assert plan.plant.__doc__


def test_the_plant_gets_the_name_and_the_magnitudes(recorded, say, own_folder, rig):
    say("new", rig, *recorded("carriage"))
    code = (own_folder / f"{rig}/{rig}.py").read_text()
    assert f'name = "{rig}"' in code
    values = {
        line.split(" = ")[0]: line.split("#")[0].split(" = ")[1]
        for line in code.splitlines()
        if "  # " in line
    }
    assert float(values["STROKE"]) == pytest.approx(0.3, rel=0.5)
    assert float(values["SPEED"]) == pytest.approx(0.9, rel=0.3)
    assert float(values["FORCE"]) == pytest.approx(9.0, rel=0.1)


def test_several_recordings_the_last_one_judges(recorded, say, own_folder, rig):
    words = recorded("rotary")
    for name in ("night run", "2nd"):
        (own_folder / f"{name}.csv").write_text((own_folder / "rotary.csv").read_text())
    assert say("new", rig, "--from", "night run.csv", "2nd.csv", *words[2:]).code == 0
    case = yaml.safe_load((own_folder / f"{rig}/case/{rig}.yaml").read_text())
    assert "trace" not in case
    assert case["records"] == {
        "night_run": {"files": "../night run.csv", "role": "identification"},
        "2nd": {"files": "../2nd.csv", "role": "validation"},
    }
    assert say("preprocess", "--config-dir", rig, f"case={rig}", "mlflow.enabled=false").code == 0


def test_of_free_decays_all_are_traced(say, own_folder, rig):
    """One of them alone cannot tell amplitude from time."""
    time = np.arange(0.0, 20.0, 0.01)
    for name, amplitude in (("high", 0.8), ("low", 0.3)):
        angle = amplitude * np.exp(-0.1 * time) * np.cos(4.5 * time)
        rows = np.column_stack([time, angle])
        np.savetxt(own_folder / f"{name}.csv", rows, delimiter=",", header="time,angle_rad", comments="")
    words = ("new", rig, "--from", "high.csv", "low.csv", "--template", "pendulum")
    said = say(*words)
    assert said.code == 0, said.complaint
    case = yaml.safe_load((own_folder / f"{rig}/case/{rig}.yaml").read_text())
    assert case["trace"] == {"records": ["high", "low"], "held_out": None}


def test_of_a_body_that_cools_parts_of_the_recording_judge(say, own_folder, rig):
    """Its last part is as cold as the room: there the loss shows little."""
    time = np.arange(0.0, 6000.0, 20.0)
    rows = np.column_stack([time, 22.0 + 60.0 * np.exp(-time / 1500.0)])
    np.savetxt(own_folder / "mug.csv", rows, delimiter=",", header="time [s],temperature [°C]", comments="")
    words = ("--from", "mug.csv", "--template", "heater", "--signal", "power=none")
    said = say("new", rig, *words)
    assert said.code == 0, said.complaint
    case = yaml.safe_load((own_folder / f"{rig}/case/{rig}.yaml").read_text())
    assert case["trace"] == {"records": ["fitted", "judging"], "held_out": None}


def test_of_one_pulse_parts_of_the_recording_judge(say, own_folder, rig):
    """After it nothing drives the machine: place, speed and time go together there."""
    time = np.arange(0.0, 4.0, 0.005)
    torque = np.where((time > 0.5) & (time < 1.0), 0.2, 0.0)
    angle = np.cumsum(np.cumsum(torque) * 0.005) * 0.005
    rows = np.column_stack([time, torque, angle])
    names = "time [s],torque [N·m],angle [rad]"
    np.savetxt(own_folder / "pulse.csv", rows, delimiter=",", header=names, comments="", encoding="utf-8")
    said = say("new", rig, "--from", "pulse.csv", "--template", "rotary")
    assert said.code == 0, said.complaint
    case = yaml.safe_load((own_folder / f"{rig}/case/{rig}.yaml").read_text())
    assert case["trace"] == {"records": ["fitted", "judging"], "held_out": None}


def test_a_room_is_a_heater_in_surroundings_that_are_measured():
    """At random states the two move alike, and an effect sees the temperature above the surroundings."""
    heater, room = (compose(template(kind).plant(), ["thermal_radiation"]) for kind in ("heater", "room"))
    values = {"C": 2e6, "h": 60.0, "body.thermal_radiation.k": 20.0}
    for outside, warm, power in np.random.default_rng(0).uniform([-10, 0, 0], [20, 60, 2000], (10, 3)):
        constant = heater.f(0, [warm], [power], heater.values({**values, "T_0": outside}))
        measured = room.f(0, [warm], [power, outside], room.values(values))
        assert np.asarray(measured) == pytest.approx(np.asarray(constant))


def test_a_torsional_oscillator_is_an_oscillator_that_turns():
    """At random states the two move alike, also under friction that grows with drive and load."""
    effects = ["viscous", "load_friction"]
    shifted, turned = (
        compose(template(kind).plant(), effects) for kind in ("oscillator", "torsional_oscillator")
    )
    friction = {"spring.viscous.f_v": 0.03, "spring.load_friction.mu": 0.3, "spring.epsilon": 0.01}
    values = {"K": 6.0, **friction}
    for q, speed, drive in np.random.default_rng(0).uniform(-1, 1, (10, 3)):
        shifting = shifted.f(0, [q, speed], [drive], shifted.values({**values, "M": 0.02}))
        turning = turned.f(0, [q, speed], [drive], turned.values({**values, "J": 0.02}))
        assert np.asarray(turning) == pytest.approx(np.asarray(shifting))


@pytest.mark.parametrize(("kind", "made"), [("test_rig", "differentiate"), ("vehicle", "integrate")])
def test_each_of_several_recordings_has_its_own_steps(recorded, say, own_folder, rig, kind, made):
    words = recorded(kind)
    for name in ("a", "b"):
        (own_folder / f"{name}.csv").write_text((own_folder / f"{kind}.csv").read_text())
    assert say("new", rig, "--from", "a.csv", "b.csv", *words[2:]).code == 0
    records = yaml.safe_load((own_folder / f"{rig}/case/{rig}.yaml").read_text())["records"]
    assert [one["files"] for one in records.values()] == ["../a.csv", "../b.csv"]
    assert all(one["steps"][0]["step"] == made for one in records.values())
    assert say("preprocess", "--config-dir", rig, f"case={rig}", "mlflow.enabled=false").code == 0


def test_constants_of_the_recordings_become_parameters(recorded, machine, say, rig, own_folder):
    """Two servos with other gains: the column that holds the gain gives it to each record."""
    words = recorded("servo")
    for name, gain in (("low", 400), ("high", 800)):
        lines = machine("servo").text.splitlines()[:2001]
        (own_folder / f"{name}.csv").write_text(
            "\n".join([f"{lines[0]},kp", *(f"{x},{gain}" for x in lines[1:])])
        )
    from_both = ("--from", "low.csv", "high.csv", *words[2:])
    said = say("new", rig, *from_both, "--constant", "k_p=kp", "--scale", "k_p=0.01")
    assert said.code == 0, said.complaint
    assert "low: 2000 samples, 3.998 s, k_p 4" in said.out
    records = yaml.safe_load((own_folder / f"{rig}/case/{rig}.yaml").read_text())["records"]
    assert [one["parameters"] for one in records.values()] == [{"k_p": 4.0}, {"k_p": 8.0}]
    assert say("fit", "--config-dir", rig, f"case={rig}", "out=fit", "mlflow.enabled=false").code == 0
    assert "k_p" not in json.loads((own_folder / "fit/fit/estimate.json").read_text())["parameters"]


def test_a_parameter_of_a_new_case_may_differ_by_recording(recorded, say, own_folder, rig):
    """Three copies of one recording, two of them fitted: their values are one."""
    words = recorded("carriage")
    for name in ("a", "b", "c"):
        (own_folder / f"{name}.csv").write_text((own_folder / "carriage.csv").read_text())
    assert say("new", rig, "--from", "a.csv", "b.csv", "c.csv", *words[2:]).code == 0
    by = "parameters.guide.coulomb.f_c.by=record"
    said = say("validate", "--config-dir", rig, f"case={rig}", by, "out=tree", "mlflow.enabled=false")
    assert said.code == 0, said.complaint
    found = json.loads((own_folder / "tree/fit/estimate.json").read_text())
    values = [found["parameters"][f"guide.coulomb.f_c[{name}]"]["value"] for name in ("a", "b")]
    assert values == pytest.approx([1.5, 1.5], rel=0.05)
    assert found["differences"]["guide.coulomb.f_c"]["p_value"] > 0.9
    assert "record c is not fitted, so guide.coulomb.f_c has no value of its own there" in said.err


def test_cells_that_are_missing_are_masked(recorded, machine, say, own_folder, rig):
    """The link's encoder drops out: the case says so, and the motor's angle there counts."""
    words = recorded("two_inertias")
    header, *lines = machine("two_inertias").text.splitlines()
    gone = [line.rpartition("\t")[0] + "\t" if k % 500 < 50 else line for k, line in enumerate(lines)]
    (own_folder / "two_inertias.csv").write_text("\n".join([header, *gone]))
    said = say("new", rig, *words)
    assert said.code == 0, said.complaint
    told = "'link_angle' is missing at 250 of the 2500 samples of its files, the first at t = 0 s: masked"
    assert told in said.out
    outputs = yaml.safe_load((own_folder / f"{rig}/case/{rig}.yaml").read_text())["signals"]["outputs"]
    assert {name: one.get("missing") for name, one in outputs.items()} == {
        "motor_angle": None,
        "link_angle": "mask",
    }
    validate = ("validate", "--config-dir", rig, f"case={rig}", "mlflow.enabled=false", "out=tree")
    assert say(*validate).code == 0
    found = json.loads((own_folder / "tree/fit/estimate.json").read_text())["parameters"]
    for name, value in machine("two_inertias").truth.items():
        assert found[name]["value"] == pytest.approx(value, rel=0.02)
    rows = json.loads((own_folder / "tree/validate/metrics.json").read_text())
    counted = {row["output"]: row["n"] for row in rows if row["record"] == "fitted"}
    assert counted == {"motor_angle": 1750, "link_angle": 1550}
    refused = say(*validate, "signals.outputs.link_angle.missing=refuse")
    assert "set signals.outputs.link_angle.missing=mask" in refused.complaint
