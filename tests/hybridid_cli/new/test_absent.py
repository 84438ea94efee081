"""Templates without one of their signals: ``--signal force=none``, where nothing drives the machine, and
``--signal upper_level=none``, where a level is not measured."""

from __future__ import annotations

import io
import json
import re
import sys

import numpy as np
import pytest
import yaml

from hybridid.model import compose
from hybridid.plants.plant import Plant
from pipelines.new.template import kinds, template

LACKS = [(kind, name) for kind in kinds() for name in template(kind).about.without]


def lacking(kind, *names):
    plan = template(kind)
    return plan.without([one for one in (*plan.inputs, *plan.outputs) if one.name in names])


def written(plan):
    space = {}
    exec(plan.code("rig", {}), space)
    return next(
        one for one in space.values() if isinstance(one, type) and issubclass(one, Plant) and one != Plant
    )()


def test_every_driven_template_but_two_may_coast():
    """A servo whose goal is not recorded is another machine: its controller works all the same. So is a motor
    whose voltage is not: it brakes by its back-EMF, or its terminals are open."""
    driven = {kind for kind in kinds() if template(kind).inputs}
    assert driven - {kind for kind, _ in LACKS} == {"servo", "dc_motor"}
    unmeasured = [(kind, name) for kind, name in LACKS if lacking(kind, name).hides]
    assert unmeasured == [("two_tanks", "upper_level")], "as docs/your-machine.md says"


@pytest.mark.parametrize(("kind", "name"), [*LACKS, ("two_tanks", "inflow upper_level")])
def test_the_plant_is_one_without_the_signal(kind, name):
    gone = name.split()
    plan = lacking(kind, *gone)
    model = compose(written(plan), list(plan.about.effects))
    plant = model.plant
    assert {one.name for one in plan.absent} == set(gone)
    assert not set(gone) & {one.name for one in (*plant.inputs, *plant.outputs, *plant.ports)}
    assert not set(gone) & {state.observed_by for state in plant.states}
    assert not any(f"u.{one}" in plan.source or f'"{one}"' in plan.source for one in gone)
    known = {template(kind).about.without[one].known for one in gone}
    assert known <= {parameter.name for parameter in plant.parameters if parameter.fixed}
    assert plan.outputs
    rate = model.f(0, np.ones(len(model.states)), np.ones(len(model.inputs)), model.values())
    assert np.isfinite(np.asarray(rate)).all()


@pytest.mark.parametrize(("kind", "name"), LACKS)
def test_what_a_lack_replaces_is_there(kind, name):
    plan = template(kind)
    lack = plan.about.without[name]
    assert all(said in plan.source or said in plan.about.meaning for said in lack.words)
    assert all(re.search(rf"(?m)^{constant} = ", plan.source) for constant in (*lack.head, *lack.scales))


@pytest.mark.parametrize(
    ("kind", "drive", "inertia"), [("oscillator", "force", "M"), ("torsional_oscillator", "torque", "J")]
)
def test_the_equations_are_those_of_a_zero_input(kind, drive, inertia):
    """At random states the plant that coasts moves as the driven one under no force or torque."""
    coasting = written(lacking(kind, drive))
    driven, free = (compose(plant, ["viscous"]) for plant in (template(kind).plant(), coasting))
    values = {inertia: 2.0, "K": 3.0, "spring.viscous.f_v": 0.4}
    for x in np.random.default_rng(0).uniform(-1, 1, (10, 2)):
        zero = driven.f(0, x, [0.0], driven.values(values))
        named = {p.name: values.get(p.name, p.guess) for p in free.parameters}
        assert np.asarray(free.f(0, x, [], free.values(named))) == pytest.approx(np.asarray(zero))


def coast_down(mass=1200.0, rolling=150.0, drag=0.4, speed=30.0):
    """Time and speed of a car that rolls to a stand: ``M v' = -(f_c + c_d v²)``, solved in closed form."""
    t = np.arange(0.0, 120.0, 0.5)
    fast = np.sqrt(rolling / drag)
    v = fast * np.tan(np.arctan(speed / fast) - np.sqrt(rolling * drag) / mass * t)
    noise = np.random.default_rng(1).normal(0.0, 0.005, len(t))
    return [f"{a:.1f},{3.6 * b:.4f}" for a, b in zip(t, v + noise, strict=True) if b > 1.0]


def test_a_coast_down_is_fitted_without_a_force(say, own_folder, rig):
    for name, speed in (("fast", 30.0), ("slow", 22.0)):
        rows = "\n".join(coast_down(speed=speed))
        (own_folder / f"{name}.csv").write_text(f"t,speed [km/h]\n{rows}\n")
    words = ("new", rig, "--from", "fast.csv", "slow.csv", "--template", "vehicle")
    assert "if nothing drives it, --signal force=none; columns left: none" in say(*words).complaint
    said = say(*words, "--signal", "force=none")
    assert said.code == 0, said.complaint
    assert re.search(r"(?m)^ force +none: nothing drives it +N ", said.out)
    assert "M is 1 kg unless you set MASS" in said.out
    text = (own_folder / f"{rig}/case/{rig}.yaml").read_text()
    assert "  # no force: nothing drives it\n" in text
    assert "inputs" not in yaml.safe_load(text)["signals"]
    plant = own_folder / f"{rig}/{rig}.py"
    plant.write_text(plant.read_text().replace("MASS = 1.0 ", "MASS = 1200.0 "))
    run = ("fit", "--config-dir", rig, f"case={rig}", "effects=[coulomb,quadratic_drag]", "out=tree")
    said = say(*run, "mlflow.enabled=false")
    assert said.code == 0, said.complaint
    found = json.loads((own_folder / "tree/fit/estimate.json").read_text())["parameters"]
    values = {name: found[name]["value"] for name in found}
    assert values == pytest.approx({"road.coulomb.f_c": 150.0, "road.quadratic_drag.c_d": 0.4}, rel=0.03)


def decay(amplitude, inertia=0.02, stiffness=6.0, damping=0.006):
    """Time and angle of a torsional oscillator let go at ``amplitude`` in °, solved in closed form."""
    t = np.arange(0.0, 10.0, 0.01)
    rate = damping / (2 * inertia)
    w = np.sqrt(stiffness / inertia - rate**2)
    angle = amplitude * np.exp(-rate * t) * (np.cos(w * t) + rate / w * np.sin(w * t))
    noise = np.random.default_rng(1).normal(0.0, 0.02, len(t))
    return [f"{a:.2f},{b:.4f}" for a, b in zip(t, angle + noise, strict=True)]


def test_a_decay_of_a_torsional_oscillator_is_fitted_without_a_torque(say, own_folder, rig):
    for name, amplitude in (("wide", 30.0), ("narrow", 12.0)):
        rows = "\n".join(decay(amplitude))
        (own_folder / f"{name}.csv").write_text(f"t [s],twist [deg]\n{rows}\n")
    files = ("--from", "wide.csv", "narrow.csv")
    said = say("new", rig, *files, "--template", "torsional_oscillator", "--signal", "torque=none")
    assert said.code == 0, said.complaint
    assert "an inertia on a torsional spring, which swings freely" in said.out
    assert re.search(r"(?m)^ torque +none: nothing drives it +N·m ", said.out)
    assert "J is 1 kg·m² unless you set INERTIA" in said.out
    case = yaml.safe_load((own_folder / f"{rig}/case/{rig}.yaml").read_text())
    assert "inputs" not in case["signals"]
    assert case["trace"] == {"records": ["wide", "narrow"], "held_out": None}
    plant = own_folder / f"{rig}/{rig}.py"
    plant.write_text(plant.read_text().replace("INERTIA = 1.0 ", "INERTIA = 0.02 "))
    said = say("fit", "--config-dir", rig, f"case={rig}", "out=tree", "mlflow.enabled=false")
    assert said.code == 0, said.complaint
    found = json.loads((own_folder / "tree/fit/estimate.json").read_text())["parameters"]
    values = {name: found[name]["value"] for name in found}
    assert values == pytest.approx({"K": 6.0, "spring.viscous.f_v": 0.006}, rel=0.01)


def test_a_level_that_is_not_measured_is_estimated(recorded, say, own_folder, rig):
    """The fit finds the planted parameters from the lower level alone, over the section of the upper tank."""
    said = say("new", rig, *recorded("two_tanks"), "--signal", "upper_level=none")
    assert said.code == 0, said.complaint
    assert re.search(r"(?m)^ upper_level +none: not measured +m ", said.out)
    text = (own_folder / f"{rig}/case/{rig}.yaml").read_text()
    assert "    # no upper_level: not measured, so the fit estimates its state\n" in text
    case = yaml.safe_load(text)
    assert case["signals"]["outputs"].keys() == {"lower_level"}
    assert case["estimator"] == {"horizon": None}
    run = ("validate", "--config-dir", rig, f"case={rig}", "parameters.A_1.fixed=0.02", "out=tree")
    said = say(*run, "mlflow.enabled=false")
    assert said.code == 0, said.complaint
    found = json.loads((own_folder / "tree/fit/estimate.json").read_text())["parameters"]
    values = {name: found[name]["value"] for name in found}
    assert values == pytest.approx({"A_2": 0.03, "c_1": 4e-4, "c_2": 4.4e-4}, rel=0.02)


def test_of_two_levels_one_column_asks_which_is_measured(say, own_folder):
    rows = "\n".join(f"{k},{k % 9},{k % 7}" for k in range(100))
    (own_folder / "tanks.csv").write_text(f"t,pump,level [m]\n{rows}\n")
    said = say("new", "rig", "--from", "tanks.csv", "--template", "two_tanks")
    assert said.complaint.endswith(
        "which column is upper_level, the level of the upper tank over its outlet; which is lower_level, the "
        "level of the lower tank over its outlet? Give --signal upper_level=COLUMN --signal "
        "lower_level=COLUMN, or, if not measured, --signal upper_level=none; columns left: level [m]"
    )


def test_on_a_terminal_none_is_an_answer(say, own_folder, monkeypatch, rig):
    class Screen(io.StringIO):
        def isatty(self):
            return True

    (own_folder / "run.csv").write_text("t,speed\n" + "\n".join(f"{k},{np.exp(-k / 50)}" for k in range(100)))
    monkeypatch.setattr(sys, "stdin", Screen("none\n"))
    screen = Screen()
    monkeypatch.setattr(sys, "stderr", screen)
    assert say("new", rig, "--from", "run.csv", "--template", "spindle").code == 0
    assert (
        "Which column is torque, the torque of the drive [N·m]? None: nothing drives it." in screen.getvalue()
    )


def test_a_column_may_be_called_none(say, own_folder, rig):
    rows = "\n".join(f"{0.01 * k},{np.sin(0.1 * k)},{np.cos(0.3 * k)}" for k in range(200))
    (own_folder / "run.csv").write_text(f"t,none,angle\n{rows}\n")
    words = ("--from", "run.csv", "--template", "rotary", "--signal", "torque=none")
    assert say("new", rig, *words).code == 0
    case = yaml.safe_load((own_folder / f"{rig}/case/{rig}.yaml").read_text())
    assert case["signals"]["inputs"]["torque"]["column"] == "none"


def test_a_column_that_never_changes_is_listed_as_that(say, rig, own_folder):
    rows = "".join(f"{k / 100},0.5,{k % 7}\n" for k in range(200))
    (own_folder / "stuck.csv").write_text(f"t [s],angle [rad],torque [N·m]\n{rows}")
    told = say("new", rig, "--from", "stuck.csv", "--template", "rotary").complaint
    assert told.endswith("columns left: angle [rad] (constant in the first recording)")
