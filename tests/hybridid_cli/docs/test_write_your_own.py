"""``docs/write-your-own.md``: its files, commands and code run, and give what was simulated."""

from __future__ import annotations

import json
import re
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import odeint

PAGE = "write-your-own.md"
LAB = ("--config-dir", "mylab")
OUTPUTS = Path(__file__).parents[3] / "outputs" / "README.md"
EDGE, WEIR = 0.45, 0.03  # of an overflow that the page's tank does not have; m, m^1.5/s


@pytest.fixture(scope="module", autouse=True)
def swing(built, bench):
    """A held random torque on the pendulum with its cable."""
    generator = np.random.default_rng(0)
    torque = bench.held(generator, 0.8)
    angle = bench.swung(bench.cable, lambda k, _: torque[k])
    bench.write(built / "mylab/swing.csv", torque, angle + generator.normal(0, 1e-3, bench.samples))


@pytest.fixture
def printed_by(laboratory, say):
    """``printed_by(*words)``: what a command that succeeds prints in the folder of the page."""

    def typed(*words: str) -> str:
        said = say(*words)
        assert said.code == 0, said.err
        return said.out

    return typed


def test_own_folder_is_fitted_by_the_command_of_the_page(laboratory, page, fit, bench):
    command = re.search(r"^hybridid fit (.*)$", page(PAGE), flags=re.MULTILINE)[1].split()
    assert fit(*command, out="fitted").code == 0
    found = json.loads((laboratory / "fitted/fit/estimate.json").read_text())["parameters"]
    for name, truth in bench.cable.items():
        assert found[name]["value"] == pytest.approx(truth, rel=0.02), name
        assert abs(found[name]["value"] - truth) < 4 * found[name]["std"], name

    described = OUTPUTS.read_text().replace("<record>", "swing")
    left = [p.name for p in (laboratory / "fitted").rglob("*") if p.is_file() and not p.name.startswith(".")]
    assert [name for name in left if name not in described] == []


def test_own_folder_is_listed(printed_by):
    assert "a pendulum on a motor shaft" in printed_by("cases", *LAB)
    said = printed_by("effects", "pendulum:CABLE", *LAB)
    assert "k_3 q³" in said
    assert "our lab, 2026" in said


def test_the_load_of_the_page_is_listed_and_an_effect_sees_it(printed_by, printed):
    said = printed_by("cases", "pendulum", *LAB)
    assert "pivot: drive: motor torque through the gear; load: torque of the weight" in said
    said = printed_by("effects", "pendulum:GEAR_LOSS", *LAB)
    assert "needs     the effort that the port carries" in said
    seen = """
from hybridid.model import compose
from pendulum import GEAR_LOSS, Pendulum

model = compose(Pendulum(), [GEAR_LOSS, "two_sided_load_friction"])
values = model.values({"pivot.gear_loss.mu": 0.1, "pivot.two_sided_load_friction.mu_d": 0.2,
                       "pivot.two_sided_load_friction.mu_l": 0.0})
print(*map(float, model.efforts(0, [0.5, 1.0], [0.3], values).elements()))
"""
    gear, drive = map(float, printed(seen).split())
    assert gear == pytest.approx(0.1 * 1.0 * np.sin(0.5))
    assert drive == pytest.approx(0.2 * 0.3)


def test_the_effect_of_the_page_sees_a_channel_that_the_case_lists(laboratory, blocks, printed_by, printed):
    """The case with the page's lines of YAML beside its own."""
    (lines,) = (block for block in blocks(PAGE, "yaml") if block.startswith("signals:\n  auxiliary"))
    (laboratory / "mylab/case/warm.yaml").write_text(
        f"# @package _global_\ndefaults: [pendulum]\neffects: [viscous, 'grease:GREASE']\n{lines}"
    )
    said = printed_by("cases", "warm", *LAB)
    assert "inputs   torque [N·m]" in said
    assert "channels temperature [°C]" in said
    assert "cold_grease@pivot" in said
    seen = """
from grease import GREASE
from hybridid.declarations import Signal
from hybridid.model import compose
from pendulum import Pendulum

model = compose(Pendulum(), [GREASE], channels=[Signal("temperature", "°C")])
values = model.values({"pivot.cold_grease.f": 0.2, "pivot.cold_grease.T_0": 30.0})
print(float(model.efforts(0, [0.5, 1.0], [0.3, 15.0], values)))
"""
    assert float(printed(seen)) == pytest.approx(0.2 * np.exp(-0.5))


def write_controlled(bench, path: Path) -> None:
    """The page's controller drives the true pendulum: each second sample, one sample late, kp 3 N·m/rad."""
    time = bench.dt * np.arange(1000)
    goal = 0.4 * np.sin(2 * np.pi * 0.7 * time) + 0.2 * np.sign(np.sin(2 * np.pi * 0.3 * time))
    previous, waiting, torque = 0.0, 0.0, np.empty(1000)

    def command(k: int, angle: float) -> float:
        nonlocal previous, waiting
        torque[k] = waiting
        if k % 2 == 0:
            seen = 1e-4 * np.floor(angle / 1e-4 + 0.5)
            waiting = np.clip(3.0 * (goal[k] - seen) - 0.1 * (seen - previous) / (2 * bench.dt), -1.5, 1.5)
            previous = seen
        return torque[k]

    angle = bench.swung(bench.cable, command, 1000, start=0.0)
    bench.write(path, torque, angle, goal=goal)


def test_the_controller_of_the_page_runs_the_pendulum(laboratory, blocks, bench, printed_by):
    """The case with the page's lines of YAML beside its own: its law is checked, then closed."""
    write_controlled(bench, laboratory / "mylab/controlled.csv")
    (lines,) = (block for block in blocks(PAGE, "yaml") if block.startswith("controller:"))
    (laboratory / "mylab/case/held.yaml").write_text(
        "# @package _global_\ndefaults: [pendulum]\n"
        f"records: {{swing: {{files: controlled.csv, role: identification}}}}\n{lines}"
    )
    words = ("validate", *LAB, "case=held", "mlflow.enabled=false", "validate.views=[loop]", "out=held")
    said = printed_by(*words)
    (law,) = json.loads((laboratory / "held/validate/law.json").read_text())
    assert law["share"] < 1e-4
    rows = {r["output"]: r for r in json.loads((laboratory / "held/validate/metrics.json").read_text())}
    assert rows["angle"]["rmse"] < 5e-3  # rad, of a swing of 1 rad
    assert rows["torque"]["r2"] > 0.99
    assert "the law of pd gives the recorded torque within" in said
    assert "too far apart: not simulated" in printed_by(*words, "controller.parameters.kp=2")


def test_the_tank_of_the_page_takes_flows_only(printed_by, say):
    words = ("cases", "tank", *LAB)
    said = printed_by(*words, "effects=[overflow]")
    assert "effects  overflow@tank" in said
    assert "ports    tank (flow), inflow (input), level (output)" in said
    assert "load" not in said
    refused = say(*words, "effects=[viscous@tank]")
    assert refused.code == 2
    assert refused.err == "hybridid: effect viscous acts at effort ports; tank is of kind flow\n"


def write_filling(path: Path) -> None:
    """A held swinging inflow to a tank of the page's guesses, which overflows; in L/s and cm."""
    time = np.arange(400.0)
    inflow = 4e-4 * (1 + np.sin(2 * np.pi * time / 120))

    def rate(_, h, u):
        return [(u - 5e-4 * np.sqrt(h[0]) - WEIR * max(h[0] - EDGE, 0) ** 1.5) / 0.02]

    h, level = np.array([0.3]), np.empty(400)
    for k in range(400):
        level[k] = h[0]
        h = odeint(rate, h, (0, 1.0), (inflow[k],), tfirst=True, rtol=1e-9, atol=1e-11)[-1]
    level += np.random.default_rng(0).normal(0, 3e-4, 400)
    columns = np.column_stack([time, 1e3 * inflow, 100 * level])
    np.savetxt(path, columns, delimiter=",", header="t,pump,level", comments="", fmt="%.9g")


def test_an_overflow_of_the_page_s_tank_is_fitted(laboratory, printed):
    write_filling(laboratory / "mylab/filling.csv")
    code = """
from hybridid.estimators import FitSettings, fit
from hybridid.model import compose
from hybridid.records.mapping import SignalMap, TimeMap, build_record
from tank import Tank

inputs = [SignalMap("inflow", "m³/s", "pump", scale=1e-3, hold="zoh")]
outputs = [SignalMap("level", "m", "level", scale=0.01)]
record = build_record("filling", ["mylab/filling.csv"], TimeMap(column="t", unit="s"), inputs, outputs)
model = compose(Tank(), ["overflow"], {"tank.overflow.h": {"fixed": 1.0}})
found = fit(model, [record], FitSettings(substeps=4), start_values={"tank.overflow.limit": 0.4})
print(*(found.values[name] for name in ("c", "tank.overflow.k", "tank.overflow.limit")))
"""
    outlet, weir, edge = map(float, printed(code).split())
    assert outlet == pytest.approx(5e-4, rel=0.01)
    assert weir == pytest.approx(WEIR, rel=0.05)
    assert edge == pytest.approx(EDGE, abs=2e-3)


def test_notebook_example_finds_the_same(blocks, printed, bench):
    values = {line.split()[0]: float(line.split()[1]) for line in printed(blocks(PAGE)[-1]).splitlines()}
    for name in ("J", "pivot.cable.k_3"):
        assert values[name] == pytest.approx(bench.cable[name], rel=0.02)
