"""``docs/your-data.md``: its files and commands run on recordings with all that the page speaks of."""

from __future__ import annotations

import json
import re
import shlex
from functools import cache
from pathlib import Path

import numpy as np
import pytest

PAGE = "your-data.md"


@pytest.fixture(scope="module")
def motion(bench):
    """``motion(seed, by_hand)``: time, held torque, angle with noise and whether the drive is on. Moved by
    hand, it is off from 4 to 6 s."""

    @cache
    def made(seed: int, by_hand: bool) -> tuple[np.ndarray, ...]:
        generator = np.random.default_rng(seed)
        time, torque = bench.dt * np.arange(bench.samples), bench.held(generator, 0.5)
        on = (time < 4) | (time >= 6) if by_hand else np.full(bench.samples, True)
        moved = 1.2 * np.sin(2 * np.pi * 0.8 * (time - 4)) + (time - 4) * 0.2
        hand = {k: moved[k] for k in np.flatnonzero(~on).tolist()}
        angle = bench.swung(bench.alone, lambda k, _: torque[k], hand=hand)
        return time, torque, angle + generator.normal(0, 1e-3, bench.samples), on

    return made


@pytest.fixture(scope="module", autouse=True)
def recordings(built, write_files, motion):
    """The files of the page, and two recordings: CSV, and uneven JSON lines."""
    assert write_files(PAGE, built) == {"case/bench.yaml", "case/robot.yaml"}
    time, torque, angle, on = motion(1, by_hand=True)
    lines = ["t_ms;current;angle_deg;enable"]
    rows = zip(1e3 * time, torque / 0.05, -np.rad2deg(angle), on, strict=True)
    lines += [";".join(f"{value:.9g}".replace(".", ",") for value in row) for row in rows]
    (built / "mylab/bench_1.csv").write_text("\n".join(lines))
    time, torque, angle, _ = motion(2, by_hand=False)
    late = time + np.random.default_rng(3).uniform(0, 1e-3, len(time))
    late = np.where(np.arange(len(time)) % 50 == 0, time, late)  # the torque changes at even stamps
    columns = zip(late.tolist(), torque.tolist(), np.interp(late, time, angle).tolist(), strict=True)
    samples = (dict(zip(("stamp", "torque", "angle"), row, strict=True)) for row in columns)
    (built / "mylab/bench_2.jsonl").write_text("\n".join(map(json.dumps, samples)))


@pytest.fixture
def commands(page):
    """The words of the page's fits."""
    return [shlex.split(line) for line in re.findall(r"(?m)^hybridid fit (.*)$", page(PAGE))]


@pytest.fixture
def fitted(laboratory, fit):
    """``fitted(words, out)``: the parameters that a fit finds, and what it says on stderr."""

    def found(words, out):
        said = fit(*words, out=out)
        assert said.code in (0, 3), said.err
        return json.loads((laboratory / out / "fit/estimate.json").read_text())["parameters"], said.err

    return found


@pytest.fixture
def check_true(bench):
    """``check_true(found)``: each parameter within 2 %, and within ``errors`` standard errors if given."""

    def check(found, errors=np.inf):
        for name, truth in bench.alone.items():
            assert found[name]["value"] == pytest.approx(truth, rel=0.02), name
            assert abs(found[name]["value"] - truth) < errors * found[name]["std"], name

    return check


def test_the_mask_of_the_page_leaves_out_the_hand(fitted, commands, page, check_true, bench):
    found, said = fitted(commands[0], "masked")
    (line,) = re.findall(r"`(masked: .*?)`", page(PAGE))
    assert line in said
    check_true(found, errors=4)
    whole, _ = fitted(commands[0][:3], "unmasked")
    assert abs(whole["J"]["value"] / bench.alone["J"] - 1) > 0.25


def test_missing_cells_of_the_page_are_refused_until_the_key_is_set(
    laboratory, fit, fitted, commands, page, check_true
):
    """The drive's switch is on there: 60 angles from 3.5 s on."""
    header, *rows = (laboratory / "mylab/bench_1.csv").read_text().splitlines()
    for k in range(700, 760):
        t, current, _, on = rows[k].split(";")
        rows[k] = f"{t};{current};;{on}"
    (laboratory / "mylab/gaps.csv").write_text("\n".join([header, *rows]))
    words = [*commands[0], "records.first.files=gaps.csv"]
    refused = fit(*words, out="gaps")
    assert refused.code == 1
    (line,) = re.findall(r"(?m)^(hybridid: record first: output .*)$", page(PAGE))
    assert line in refused.err
    found, said = fitted([*words, "signals.outputs.angle.missing=mask"], "gaps")
    told = "output 'angle' is missing at 60 of the 2000 samples of its files, the first at t = 3.5 s: masked"
    assert told in said
    check_true(found)


def test_uneven_stamps_of_the_page_end_with_the_key_to_set(laboratory, fit):
    refused = fit("--config-dir", "mylab", "case=bench", "records.second.resample=null", out="uneven")
    assert refused.code == 1
    (line,) = [one for one in refused.err.splitlines() if one.startswith("hybridid:")]
    assert re.search(
        r"record second: time is uneven: .*set signals.resample=0.005 .*records.second.resample", line
    )


def write_robot(path: Path, time, torque, angle, spoiled: float) -> None:
    """Joint states at 200 Hz that are logged late, the torque at 4 Hz with stamps of its own; a share of the
    angles ``spoiled`` by a lost bit."""
    writer = pytest.importorskip(
        "mcap_ros2.writer", reason="needs the extra ros: pip install 'hybridid[ros]'"
    )
    lost = np.random.default_rng(5).random(len(time)) < spoiled
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


def test_the_robot_of_the_page_is_fitted_from_its_bag(laboratory, motion, fitted, check_true):
    write_robot(laboratory / "mylab/robot.mcap", *motion(4, by_hand=False)[:3], spoiled=0.0)
    found, _ = fitted(["--config-dir", "mylab", "case=robot"], "robot")
    check_true(found)


def test_the_loss_of_the_page_bears_outliers(laboratory, motion, fitted, commands, check_true, bench):
    write_robot(laboratory / "mylab/robot.mcap", *motion(4, by_hand=False)[:3], spoiled=0.02)
    found, _ = fitted(commands[1], "huber")
    check_true(found, errors=4)
    pulled, _ = fitted(commands[1][:-1], "squared")
    assert all(pulled[name]["std"] > 3 * found[name]["std"] for name in bench.alone)
