"""A case, a plant and an effect in a user's own folder: no file of the package is touched."""

from __future__ import annotations

import json
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import odeint

from benchmarks.torture.lab import PLANT

EFFECT = '''
"""A spring that no library knows."""
from hybridid.effects.effect import Dimension, Effect, EffectParameter

CABLE = Effect(
    id="cable", kind="effort", title="a cable", equation="F = k q", law=lambda at: at.p.k * at.position,
    parameters=(EffectParameter("k", Dimension(effort=1, position=-1), "stiffness", nests=True),),
    source="a test", pattern="grows with the angle",
)
'''
CASE = """# @package _global_
case: {title: a pendulum of our own}
plant: pendulum:Pendulum
effects: [viscous, "cable:CABLE@pivot"]
signals:
  time: {column: t}
  inputs: {torque: {column: torque, unit: N·m, hold: zoh}}
  outputs: {angle: {column: degrees, unit: rad, scale: 0.017453292519943295}}
records:
  swing: {files: swing.csv, role: identification}
"""
TRUTH = {"J": 0.02, "G": 0.9, "pivot.viscous.f_v": 0.03, "pivot.cable.k": 0.2}
DT, SAMPLES = 0.01, 1200


@cache
def recording() -> str:
    """A held random torque on the true pendulum, integrated by SciPy; the angle in degrees, with noise."""
    generator = np.random.default_rng(1)
    torque = np.repeat(generator.uniform(-1.0, 1.0, SAMPLES // 30), 30)
    J, G, f_v, k = TRUTH.values()
    x, angle = np.array([0.2, 0.0]), np.empty(SAMPLES)
    for n in range(SAMPLES):
        angle[n] = x[0]
        rate = lambda _, x, u=torque[n]: [x[1], (u - G * np.sin(x[0]) - f_v * x[1] - k * x[0]) / J]  # noqa: E731
        x = odeint(rate, x, (0, DT), tfirst=True, rtol=1e-8, atol=1e-10)[-1]
    angle = np.rad2deg(angle + generator.normal(0, 2e-4, SAMPLES))
    columns = np.column_stack([DT * np.arange(SAMPLES), torque, angle])
    rows = "\n".join(",".join(f"{value:.9g}" for value in row) for row in columns)
    return f"t,torque,degrees\n{rows}\n"


@pytest.fixture
def mylab(own_folder: Path) -> Path:
    """The case file, a plant beside it and an effect above it, and a recording."""
    lab = own_folder / "mylab"
    (lab / "case").mkdir(parents=True)
    (lab / "case" / "mine.yaml").write_text(CASE)
    (lab / "case" / "pendulum.py").write_text(PLANT)
    (lab / "cable.py").write_text(EFFECT)
    (lab / "swing.csv").write_text(recording())
    return lab


@pytest.mark.usefixtures("nothing_imported")
def test_own_case_plant_and_effect_are_fitted(say, mylab):
    said = say("validate", "--config-dir", "mylab", "case=mine", "mlflow.enabled=false", "out=tree")
    assert said.code == 0, said.err
    found = json.loads(Path("tree/fit/estimate.json").read_text())["parameters"]
    assert set(found) == set(TRUTH)
    for name, truth in TRUTH.items():
        assert found[name]["value"] == pytest.approx(truth, rel=0.02), name
    scores = json.loads(Path("tree/validate/metrics.json").read_text())
    assert {row["provenance"] for row in scores} == {"measured"}
    assert all(row["rmse"] < 3e-4 for row in scores), "2e-4 rad of noise should be all that is left"
    listed = say("cases", "--config-dir", "mylab").out
    assert "mine: a pendulum of our own" in listed
    assert "emps: " in listed
    assert "cable" in say("effects", "cable:CABLE", "--config-dir", "mylab").out


def test_a_case_or_its_folder_that_is_left_out_is_told(say, mylab, monkeypatch):
    said = say("fit", "--config-dir", "mylab")
    assert (said.code, said.complaint) == (
        2,
        "hybridid: no case is chosen: write case=mine, or case=emps if that is meant",
    )
    said = say("fit", "case=mine")
    assert said.code == 2
    assert said.complaint.startswith("hybridid: unknown case 'mine'")
    assert said.complaint.endswith("; mylab/case/mine.yaml is there: add --config-dir mylab")
    monkeypatch.chdir("mylab")
    assert say("fit", "case=mine").complaint.endswith("; case/mine.yaml is there: add --config-dir .")
    assert say("fit", "case=yours").complaint.endswith("; a case of your own needs --config-dir FOLDER")


@pytest.mark.usefixtures("nothing_imported")
def test_a_unit_that_a_factor_turns_into_the_plant_s_is_told_with_it(say, mylab):
    words = ("--config-dir", "mylab", "case=mine", "mlflow.enabled=false", "out=tree")
    said = say("fit", *words, 'signals.inputs.torque.unit="mN·m"')
    assert said.code == 1
    left_bare = say("fit", *words, "signals.inputs.torque.unit=mN·m").complaint
    assert left_bare.endswith("'signals.inputs.torque.unit=\"mN·m\"'")
    assert "needs N·m: give it unit: N·m, and scale: 0.001 if its column is in mN·m" in said.complaint


@pytest.mark.usefixtures("nothing_imported")
def test_files_that_are_no_measurement_are_marked_simulated(say, mylab):
    words = ("--config-dir", "mylab", "case=mine", "mlflow.enabled=false", "out=tree")
    said = say("validate", *words, "signals.simulated=true")
    assert said.code == 0, said.err
    assert "measured" not in said.out
    scores = json.loads(Path("tree/validate/metrics.json").read_text())
    assert {row["provenance"] for row in scores} == {"simulated"}
    listed = say("cases", "mine", "--config-dir", "mylab", "+signals.simulated=true").out
    assert "(identification): simulated, " in listed


@pytest.mark.usefixtures("nothing_imported")
@pytest.mark.parametrize("words", [(), ("fit.records=[other]",)])
def test_a_record_whose_file_is_not_there_is_told(say, mylab, words):
    """No rig stands in, so nothing is fitted without it."""
    case = mylab / "case" / "mine.yaml"
    case.write_text(CASE + "  other: {files: nowhere.csv, role: validation}\n")
    said = say("fit", "--config-dir", "mylab", "case=mine", "mlflow.enabled=false", *words)
    assert said.code == 1
    assert "record other: nowhere.csv not found" in said.complaint


@pytest.mark.usefixtures("nothing_imported")
def test_changed_python_makes_the_fit_stale(say, process, mylab):
    """In a process of its own: this one has imported what it was."""
    words = ("fit", "--config-dir", "mylab", "case=mine", "mlflow.enabled=false", "out=tree")
    assert say(*words).code == 0
    assert "fit: fresh, reused" in say(*words).err
    (mylab / "cable.py").write_text(EFFECT.replace("stiffness", "stiffness of the cable"))
    again = process(*words)
    assert "preprocess: fresh, reused" in again.err
    assert "fit: stale, the code of cable.py changed" in again.err


@pytest.mark.usefixtures("nothing_imported")
def test_broken_python_is_one_line(say, mylab):
    (mylab / "cable.py").write_text("CABLE = 1 / 0\n")
    said = say("fit", "--config-dir", "mylab", "case=mine", "mlflow.enabled=false")
    assert said.code == 2
    assert "Traceback" not in said.err
    assert "cable:CABLE" in said.complaint
    assert "division by zero" in said.complaint


@pytest.mark.usefixtures("nothing_imported", "no_figures")
def test_own_effect_is_found_and_the_model_with_it_taken_up(say, mylab):
    """Its name in the module is not its id: the augmented model must find it by its import path."""
    case = ("--config-dir", "mylab", "case=mine", "mlflow.enabled=false")
    tried = (
        "trace.effects=[cubic_stiffness]",
        "trace.extra_effects=[cable:CABLE]",
        "trace.processes=1",
        "trace.variables=[position]",
        "trace.laws=false",
    )
    said = say("trace", *case, "effects=[viscous]", *tried, "out=tree")
    assert said.code == 0, said.err
    (accepted,) = json.loads(Path("tree/trace/trace.json").read_text())["accepted"]
    assert (accepted["effect"], accepted["class"]) == ("cable", ["cable"])
    assert accepted["parameters"]["k"]["value"] == pytest.approx(TRUTH["pivot.cable.k"], rel=0.05)
    again = say("fit", *case, "model=tree/trace/model.json", "out=again")
    assert again.code == 0, again.err
    assert set(json.loads(Path("again/fit/estimate.json").read_text())["parameters"]) == set(TRUTH)
