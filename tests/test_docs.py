"""The documentation is true: its links lead somewhere, and its examples run and give what they should."""

from __future__ import annotations

import json
import os
import re
import shlex
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import odeint

ROOT = Path(__file__).parents[1]
PAGES = [
    *ROOT.glob("*.md"),
    *sorted(p for d in ("docs", "data", "outputs", "benchmarks") for p in (ROOT / d).glob("**/*.md")),
]
OWN = ROOT / "docs" / "write-your-own.md"
DATA = ROOT / "docs" / "your-data.md"
# a pendulum with a cable, simulated here: what the example is fitted to
TRUTH = {"J": 0.02, "G": 0.9, "pivot.viscous.f_v": 0.015, "pivot.coulomb.f_c": 0.03, "pivot.cable.k_3": 0.08}
DT, SAMPLES, EPSILON = 0.005, 2000, 0.01


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_links_lead_somewhere(page):
    links = re.findall(r"\]\(([^)#]+?)(?:#[^)]*)?\)", page.read_text())
    inside = [link for link in links if not re.match(r"[a-z]+:", link)]
    assert [link for link in inside if not (page.parent / link).exists()] == []


def python_blocks(page: Path) -> list[str]:
    return re.findall(r"```python\n(.*?)```", page.read_text(), flags=re.DOTALL)


def test_concepts_run():
    space: dict[str, object] = {}
    for block in python_blocks(ROOT / "docs" / "concepts.md"):
        exec(block, space)
    assert "carriage.asymmetric_viscous.df_v" in {p.name for p in space["better"].parameters}


def test_trace_runs_in_a_notebook(tmp_path, monkeypatch, capsys):
    """It prints the verdict with both errors, marked simulated, and touches no file."""
    monkeypatch.chdir(tmp_path)
    (block,) = python_blocks(ROOT / "docs" / "trace.md")
    exec(block, {})
    sentence, *rows = capsys.readouterr().out.splitlines()
    assert "asymmetric_viscous at carriage" in sentence
    assert len(rows) == 2 * 2 * 2  # records, views, with and without the network
    errors = [tuple(map(float, row.split()[3:5])) for row in rows if row.split()[1] == "horizon"]
    assert all(after < before for before, after in errors[:2])
    assert all(row.endswith("m simulated") for row in rows)
    assert list(tmp_path.iterdir()) == []


@pytest.fixture(scope="module")
def laboratory(tmp_path_factory):
    """The folder that the page builds, file by file, beside a simulated recording."""
    root = tmp_path_factory.mktemp("docs")
    files = re.findall(r"^`(mylab/\S+)`\n\n```\w+\n(.*?)```", OWN.read_text(), flags=re.DOTALL | re.MULTILINE)
    assert {name.removeprefix("mylab/") for name, _ in files} == {
        "pendulum.py", "case/pendulum.yaml", "grease.py", "swing_control.py", "tank.py", "case/tank.yaml"
    }  # fmt: skip
    for name, text in files:
        (root / name).parent.mkdir(parents=True, exist_ok=True)
        (root / name).write_text(text)
    write_swing(root / "mylab" / "swing.csv")
    write_filling(root / "mylab" / "filling.csv")
    return root


def write_swing(path: Path) -> None:
    """A held random torque on the true pendulum; as the rig's sensors give it: ms, A and backward degrees."""
    generator = np.random.default_rng(0)
    time = DT * np.arange(SAMPLES)
    torque = np.repeat(generator.uniform(-0.8, 0.8, SAMPLES // 50), 50)
    J, G, f_v, f_c, k_3 = TRUTH.values()

    def motion(_, x, u):
        resisting = f_v * x[1] + f_c * np.tanh(x[1] / EPSILON) + k_3 * x[0] ** 3
        return [x[1], (u - G * np.sin(x[0]) - resisting) / J]

    x, angle = np.array([0.3, 0.0]), np.empty(SAMPLES)
    for k in range(SAMPLES):
        angle[k] = x[0]
        x = odeint(motion, x, (0, DT), (torque[k],), tfirst=True, rtol=1e-9, atol=1e-11)[-1]
    angle += generator.normal(0, 1e-3, SAMPLES)
    columns = np.column_stack([1e3 * time, torque / 0.05, -np.rad2deg(angle)])
    np.savetxt(path, columns, delimiter=",", header="t_ms,current,angle_deg", comments="", fmt="%.9g")


def write_controlled(path: Path) -> None:
    """The page's controller drives the true pendulum: each second sample, one sample late, kp 3 N·m/rad."""
    samples, (J, G, f_v, f_c, k_3) = 1000, TRUTH.values()
    time = DT * np.arange(samples)
    goal = 0.4 * np.sin(2 * np.pi * 0.7 * time) + 0.2 * np.sign(np.sin(2 * np.pi * 0.3 * time))

    def motion(_, x, u):
        resisting = f_v * x[1] + f_c * np.tanh(x[1] / EPSILON) + k_3 * x[0] ** 3
        return [x[1], (u - G * np.sin(x[0]) - resisting) / J]

    x, previous, command, waiting = np.array([0.0, 0.0]), 0.0, 0.0, 0.0
    angle, torque = np.empty(samples), np.empty(samples)
    for k in range(samples):
        angle[k] = x[0]
        acting = waiting
        if k % 2 == 0:
            seen = 1e-4 * np.floor(x[0] / 1e-4 + 0.5)
            command = np.clip(3.0 * (goal[k] - seen) - 0.1 * (seen - previous) / (2 * DT), -1.5, 1.5)
            previous = seen
        torque[k], waiting = acting, command
        x = odeint(motion, x, (0, DT), (torque[k],), tfirst=True, rtol=1e-9, atol=1e-11)[-1]
    columns = np.column_stack([1e3 * time, torque / 0.05, -np.rad2deg(angle), goal])
    np.savetxt(path, columns, delimiter=",", header="t_ms,current,angle_deg,goal", comments="", fmt="%.12g")


EDGE, WEIR = 0.45, 0.03  # of an overflow that the page's tank does not have; m, m^1.5/s


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


def run(words: list[str], folder: Path) -> str:
    done = attempt(words, folder)
    assert done.returncode == 0, done.stderr
    return done.stdout


def attempt(words: list[str], folder: Path) -> subprocess.CompletedProcess[str]:
    environment = {k: v for k, v in os.environ.items() if k != "HYBRIDID_DATA"}
    environment["PYTHONPATH"] = os.pathsep.join([str(ROOT), str(folder / "mylab")])
    words = [sys.executable, *words]
    return subprocess.run(
        words, cwd=folder, env=environment, capture_output=True, text=True, stdin=subprocess.DEVNULL
    )


def test_own_folder_is_fitted_by_the_command_of_the_page(laboratory):
    command = re.search(r"^hybridid fit (.*)$", OWN.read_text(), flags=re.MULTILINE).group(1).split()
    run(["-m", "hybridid_cli", "fit", *command, "out=fitted", "mlflow.enabled=false"], laboratory)
    found = json.loads((laboratory / "fitted" / "fit" / "estimate.json").read_text())["parameters"]
    for name, truth in TRUTH.items():
        assert found[name]["value"] == pytest.approx(truth, rel=0.02), name
        assert abs(found[name]["value"] - truth) < 4 * found[name]["std"], name

    described = (ROOT / "outputs" / "README.md").read_text().replace("<record>", "swing")
    left = [p.name for p in (laboratory / "fitted").rglob("*") if p.is_file() and not p.name.startswith(".")]
    assert [name for name in left if name not in described] == []


def test_own_folder_is_listed(laboratory):
    assert "a pendulum on a motor shaft" in run(
        ["-m", "hybridid_cli", "cases", "--config-dir", "mylab"], laboratory
    )
    said = run(["-m", "hybridid_cli", "effects", "pendulum:CABLE", "--config-dir", "mylab"], laboratory)
    assert "k_3 q³" in said
    assert "our lab, 2026" in said


def test_the_load_of_the_page_is_listed_and_an_effect_sees_it(laboratory):
    said = run(["-m", "hybridid_cli", "cases", "pendulum", "--config-dir", "mylab"], laboratory)
    assert "pivot: drive: motor torque through the gear; load: torque of the weight" in said
    said = run(["-m", "hybridid_cli", "effects", "pendulum:GEAR_LOSS", "--config-dir", "mylab"], laboratory)
    assert "needs     the effort that the port carries" in said
    seen = """
from hybridid.model import compose
from pendulum import GEAR_LOSS, Pendulum

model = compose(Pendulum(), [GEAR_LOSS, "two_sided_load_friction"])
values = model.values({"pivot.gear_loss.mu": 0.1, "pivot.two_sided_load_friction.mu_d": 0.2,
                       "pivot.two_sided_load_friction.mu_l": 0.0})
print(*map(float, model.efforts(0, [0.5, 1.0], [0.3], values).elements()))
"""
    gear, drive = map(float, run(["-c", seen], laboratory).split())
    assert gear == pytest.approx(0.1 * 1.0 * np.sin(0.5))
    assert drive == pytest.approx(0.2 * 0.3)


def test_the_effect_of_the_page_sees_a_channel_that_the_case_lists(laboratory):
    """The case with the page's lines of YAML beside its own."""
    (lines,) = re.findall(r"```yaml\n(signals:\n  auxiliary.*?)```", OWN.read_text(), flags=re.DOTALL)
    (laboratory / "mylab" / "case" / "warm.yaml").write_text(
        f"# @package _global_\ndefaults: [pendulum]\neffects: [viscous, 'grease:GREASE']\n{lines}"
    )
    said = run(["-m", "hybridid_cli", "cases", "warm", "--config-dir", "mylab"], laboratory)
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
    assert float(run(["-c", seen], laboratory)) == pytest.approx(0.2 * np.exp(-0.5))


def test_the_controller_of_the_page_runs_the_pendulum(laboratory):
    """The case with the page's lines of YAML beside its own: its law is checked, then closed."""
    write_controlled(laboratory / "mylab" / "controlled.csv")
    (lines,) = re.findall(r"```yaml\n(controller:.*?)```", OWN.read_text(), flags=re.DOTALL)
    (laboratory / "mylab" / "case" / "held.yaml").write_text(
        "# @package _global_\ndefaults: [pendulum]\n"
        f"records: {{swing: {{files: controlled.csv, role: identification}}}}\n{lines}"
    )
    words = ["-m", "hybridid_cli", "validate", "--config-dir", "mylab", "case=held", "mlflow.enabled=false"]
    said = run([*words, "out=held", "validate.views=[loop]"], laboratory)
    (law,) = json.loads((laboratory / "held" / "validate" / "law.json").read_text())
    assert law["share"] < 1e-4
    rows = {
        r["output"]: r for r in json.loads((laboratory / "held" / "validate" / "metrics.json").read_text())
    }
    assert rows["angle"]["rmse"] < 5e-3  # rad, of a swing of 1 rad
    assert rows["torque"]["r2"] > 0.99
    assert "the law of pd gives the recorded torque within" in said
    wrong = run([*words, "out=wrong", "controller.parameters.kp=2"], laboratory)
    assert "too far apart: not simulated" in wrong


def test_the_tank_of_the_page_takes_flows_only(laboratory):
    words = ["-m", "hybridid_cli", "cases", "tank", "--config-dir", "mylab"]
    said = run([*words, "effects=[overflow]"], laboratory)
    assert "effects  overflow@tank" in said
    assert "ports    tank (flow), inflow (input), level (output)" in said
    assert "load" not in said
    done = attempt([*words, "effects=[viscous@tank]"], laboratory)
    assert done.returncode == 2
    assert done.stderr == "hybridid: effect viscous acts at effort ports; tank is of kind flow\n"


def test_an_overflow_of_the_page_s_tank_is_fitted(laboratory):
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
    outlet, weir, edge = map(float, run(["-c", code], laboratory).split())
    assert outlet == pytest.approx(5e-4, rel=0.01)
    assert weir == pytest.approx(WEIR, rel=0.05)
    assert edge == pytest.approx(EDGE, abs=2e-3)


def test_notebook_example_finds_the_same(laboratory):
    said = run(["-c", python_blocks(OWN)[-1]], laboratory)
    values = {line.split()[0]: float(line.split()[1]) for line in said.splitlines()}
    assert values["J"] == pytest.approx(TRUTH["J"], rel=0.02)
    assert values["pivot.cable.k_3"] == pytest.approx(TRUTH["pivot.cable.k_3"], rel=0.02)


BENCH = {"J": 0.02, "G": 0.9, "pivot.viscous.f_v": 0.015, "pivot.coulomb.f_c": 0.03}
"""A pendulum without a cable, simulated here: what the recordings of the page on data show."""


def bench_motion(seed: int, by_hand: bool) -> tuple[np.ndarray, ...]:
    """Time, held torque, angle with noise and whether the drive is on; off from 4 to 6 s, moved by hand."""
    generator = np.random.default_rng(seed)
    time = DT * np.arange(SAMPLES)
    torque = np.repeat(generator.uniform(-0.5, 0.5, SAMPLES // 50), 50)
    on = (time < 4) | (time >= 6) if by_hand else np.full(SAMPLES, True)
    J, G, f_v, f_c = BENCH.values()

    def motion(_, x, u):
        return [x[1], (u - G * np.sin(x[0]) - f_v * x[1] - f_c * np.tanh(x[1] / EPSILON)) / J]

    x, angle = np.array([0.3, 0.0]), np.empty(SAMPLES)
    for k in range(SAMPLES):
        if not on[k]:
            x = np.array([1.2 * np.sin(2 * np.pi * 0.8 * (time[k] - 4)) + (time[k] - 4) * 0.2, 0.0])
        angle[k] = x[0]
        if on[k]:
            x = odeint(motion, x, (0, DT), (torque[k],), tfirst=True, rtol=1e-9, atol=1e-11)[-1]
    return time, torque, angle + generator.normal(0, 1e-3, SAMPLES), on


@pytest.fixture(scope="module")
def bench(laboratory):
    """The files of the page on data, and its recordings: CSV, uneven JSON lines."""
    files = re.findall(
        r"^`(mylab/\S+)`\n\n```\w+\n(.*?)```", DATA.read_text(), flags=re.DOTALL | re.MULTILINE
    )
    assert [name for name, _ in files] == ["mylab/case/bench.yaml", "mylab/case/robot.yaml"]
    for name, text in files:
        (laboratory / name).write_text(text)
    time, torque, angle, on = bench_motion(1, by_hand=True)
    lines = ["t_ms;current;angle_deg;enable"]
    rows = zip(1e3 * time, torque / 0.05, -np.rad2deg(angle), on, strict=True)
    lines += [";".join(f"{value:.9g}".replace(".", ",") for value in row) for row in rows]
    (laboratory / "mylab" / "bench_1.csv").write_text("\n".join(lines))
    time, torque, angle, _ = bench_motion(2, by_hand=False)
    late = time + np.random.default_rng(3).uniform(0, 1e-3, SAMPLES)
    late = np.where(np.arange(SAMPLES) % 50 == 0, time, late)  # the torque changes at even stamps
    angle = np.interp(late, time, angle)
    samples = (
        {"stamp": t, "torque": u, "angle": q}
        for t, u, q in zip(late.tolist(), torque.tolist(), angle.tolist(), strict=True)
    )
    (laboratory / "mylab" / "bench_2.jsonl").write_text("\n".join(map(json.dumps, samples)))
    return laboratory


def data_commands() -> list[list[str]]:
    lines = re.findall(r"^hybridid fit (.*)$", DATA.read_text(), flags=re.MULTILINE)
    return [shlex.split(line) for line in lines]


def fitted(folder: Path, words: list[str], out: str) -> tuple[dict, str]:
    done = attempt(["-m", "hybridid_cli", "fit", *words, f"out={out}", "mlflow.enabled=false"], folder)
    assert done.returncode in (0, 3), done.stderr
    return json.loads((folder / out / "fit" / "estimate.json").read_text())["parameters"], done.stderr


def test_the_mask_of_the_page_leaves_out_the_hand(bench):
    words = data_commands()[0]
    found, said = fitted(bench, words, "masked")
    (line,) = re.findall(r"`(masked: .*?)`", DATA.read_text())
    assert line in said
    for name, truth in BENCH.items():
        assert abs(found[name]["value"] - truth) < 4 * found[name]["std"], name
        assert found[name]["value"] == pytest.approx(truth, rel=0.02), name
    whole, _ = fitted(bench, words[:3], "unmasked")
    assert abs(whole["J"]["value"] / BENCH["J"] - 1) > 0.25


def test_missing_cells_of_the_page_are_refused_until_the_key_is_set(bench):
    """The drive's switch is on there: 60 angles from 3.5 s on."""
    header, *rows = (bench / "mylab" / "bench_1.csv").read_text().splitlines()
    for k in range(700, 760):
        t, current, _, on = rows[k].split(";")
        rows[k] = f"{t};{current};;{on}"
    (bench / "mylab" / "gaps.csv").write_text("\n".join([header, *rows]))
    words = [*data_commands()[0], "records.first.files=gaps.csv"]
    refused = attempt(["-m", "hybridid_cli", "fit", *words, "out=gaps", "mlflow.enabled=false"], bench)
    assert refused.returncode == 1
    (line,) = re.findall(r"^(hybridid: record first: output .*)$", DATA.read_text(), flags=re.MULTILINE)
    assert line in refused.stderr
    found, said = fitted(bench, [*words, "signals.outputs.angle.missing=mask"], "gaps")
    told = "output 'angle' is missing at 60 of the 2000 samples of its files, the first at t = 3.5 s: masked"
    assert told in said
    for name, truth in BENCH.items():
        assert found[name]["value"] == pytest.approx(truth, rel=0.02), name


def test_uneven_stamps_of_the_page_end_with_the_key_to_set(bench):
    words = ["-m", "hybridid_cli", "fit", "--config-dir", "mylab", "case=bench", "out=uneven"]
    done = attempt([*words, "records.second.resample=null", "mlflow.enabled=false"], bench)
    assert done.returncode == 1
    (line,) = [one for one in done.stderr.splitlines() if one.startswith("hybridid:")]
    assert re.search(
        r"record second: time is uneven: .*set signals.resample=0.00501 .*records.second.resample", line
    )


def write_robot(path: Path, spoiled: float) -> None:
    """Joint states at 200 Hz that are logged late, the torque at 4 Hz with stamps of its own; a share of the
    angles ``spoiled`` by a lost bit."""
    writer = pytest.importorskip(
        "mcap_ros2.writer", reason="needs the extra ros: pip install 'hybridid[ros]'"
    )
    time, torque, angle, _ = bench_motion(4, by_hand=False)
    lost = np.random.default_rng(5).random(SAMPLES) < spoiled
    header = "\n".join(["=" * 80, "MSG: std_msgs/Header", "builtin_interfaces/Time stamp", "string frame_id"])
    joints = f"std_msgs/Header header\nstring[] name\nfloat64[] position\n{header}"
    with path.open("wb") as file, writer.Writer(file) as bag:
        state = bag.register_msgdef("sensor_msgs/JointState", joints)
        effort = bag.register_msgdef("std_msgs/Float64", "float64 data")
        for k, q in enumerate((angle + 0.125 * lost).tolist()):
            ns = 10**18 + round(time[k] * 1e9)
            if k % 50 == 0:
                bag.write_message("/torque", effort, {"data": float(torque[k])}, log_time=ns)
            stamp = {"sec": ns // 10**9, "nanosec": ns % 10**9}
            message = {"header": {"stamp": stamp, "frame_id": ""}, "name": ["pivot"], "position": [q]}
            bag.write_message("/joint_states", state, message, log_time=ns + 3_000_000)


def test_the_robot_of_the_page_is_fitted_from_its_bag(bench):
    write_robot(bench / "mylab" / "robot.mcap", spoiled=0.0)
    found, _ = fitted(bench, ["--config-dir", "mylab", "case=robot"], "robot")
    for name, truth in BENCH.items():
        assert found[name]["value"] == pytest.approx(truth, rel=0.02), name


def test_the_loss_of_the_page_bears_outliers(bench):
    write_robot(bench / "mylab" / "robot.mcap", spoiled=0.02)
    words = data_commands()[1]
    found, _ = fitted(bench, words, "huber")
    for name, truth in BENCH.items():
        assert found[name]["value"] == pytest.approx(truth, rel=0.02), name
        assert abs(found[name]["value"] - truth) < 4 * found[name]["std"], name
    pulled, _ = fitted(bench, words[:-1], "squared")
    assert all(pulled[name]["std"] > 3 * found[name]["std"] for name in BENCH)
