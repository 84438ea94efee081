"""What ``hybridid new`` finds out, asks and refuses. Whatever is wrong costs one line and writes nothing."""

from __future__ import annotations

import errno
import io
import sys

import numpy as np
import pytest
import yaml

from hybridid_cli.creating import _request
from pipelines.new.template import kinds


def signals_of(folder, rig):
    return yaml.safe_load((folder / f"{rig}/case/{rig}.yaml").read_text())["signals"]


def test_without_words_the_templates_are_listed(say):
    said = say("new")
    assert said.code == 0
    assert all(kind in said.out for kind in kinds())


def test_units_signals_time_and_decimal_commas_are_found(recorded, say, own_folder, rig):
    said = say("new", rig, *recorded("rotary"))
    assert said.code == 0
    found = signals_of(own_folder, rig)
    assert found["time"] == {"column": "Zeit", "unit": "s"}
    torque, angle = found["inputs"]["torque"], found["outputs"]["angle"]
    assert (torque["column"], torque["scale"]) == ("Drehmoment_mNm", 1e-3)
    assert (angle["column"], angle["unit"]) == ("Winkel [°]", "rad")
    assert angle["scale"] == pytest.approx(np.pi / 180)
    assert f"hybridid trace --config-dir {rig} case={rig}" in said.out


def test_a_unit_that_nothing_tells_is_called_assumed(recorded, say, own_folder, rig):
    said = say("new", rig, *recorded("servo"))
    assert "assumed: the header names no unit" in said.out
    assert "set them to what your controller" in said.out
    assert "recorded in" not in (own_folder / f"{rig}/case/{rig}.yaml").read_text()


def test_a_held_input_is_declared_held(recorded, say, own_folder, rig):
    say("new", rig, *recorded("tank"))
    assert signals_of(own_folder, rig)["inputs"]["inflow"]["hold"] == "zoh"


def test_what_is_not_known_to_be_held_is_left_open(recorded, say, own_folder, rig):
    words = [word for word in recorded("carriage") if word not in ("--hold", "force=foh")]
    assert "not given: assumed held" in say("new", rig, *words).out
    assert signals_of(own_folder, rig)["inputs"]["force"]["hold"] is None


def test_slow_sampling_gets_a_horizon_of_its_own(recorded, say, own_folder, rig):
    say("new", rig, *recorded("tank"))
    case = yaml.safe_load((own_folder / f"{rig}/case/{rig}.yaml").read_text())
    assert case["validate"] == {"horizon": 50.0}
    assert case["estimator"] == {"horizon": 50}


def test_horizons_fit_into_a_short_recording(say, rig, own_folder):
    (own_folder / "run.csv").write_text(TABLE)
    say(
        "new", rig, "--from", "run.csv", "--template", "rotary", "--signal", "torque=b", "--signal", "angle=a"
    )
    case = yaml.safe_load((own_folder / f"{rig}/case/{rig}.yaml").read_text())
    assert case["validate"] == {"horizon": 0.2}  # of 2 s
    assert case["estimator"] == {"horizon": 20}


def test_a_decay_gets_horizons_as_long_as_leave_some_to_judge_by(say, rig, own_folder):
    """Nothing drives a tank that runs empty: what a leak takes adds up over all of it."""
    t = np.arange(0.0, 400.0)
    text = "".join(f"{now:.1f},{(0.9 - now / 1000) ** 2:.6f}\n" for now in t)
    (own_folder / "empty.csv").write_text(f"t [s],level [m]\n{text}")
    say("new", rig, "--from", "empty.csv", "--template", "tank", "--signal", "inflow=none")
    case = yaml.safe_load((own_folder / f"{rig}/case/{rig}.yaml").read_text())
    assert case["validate"] == {"horizon": 40.0}


def test_a_recording_too_short_to_be_divided_is_judged_by_parts(say, rig, own_folder):
    text = "".join(f"{5 * k},{(0.4 - k / 100) ** 2:.4f}\n" for k in range(26))
    (own_folder / "bottle.csv").write_text(f"t [s],level [m] \n{text}")
    say("new", rig, "--from", "bottle.csv", "--template", "tank", "--signal", "inflow=none")
    case = yaml.safe_load((own_folder / f"{rig}/case/{rig}.yaml").read_text())
    assert [one["role"] for one in case["records"].values()] == ["identification"]
    assert case["trace"] == {"records": list(case["records"]), "held_out": None}


def test_what_the_derivatives_leave_of_a_recording_is_too_short_to_judge(say, rig, own_folder):
    text = "".join(f"{k / 40},{0.1 + 0.05 * k / 40},{2 + k / 40}\n" for k in range(63))
    (own_folder / "pull.csv").write_text(f"t [s],position [m],pull [N]\n{text}")
    words = ("--signal", "displacement=position", "--signal", "force=pull")
    say("new", rig, "--from", "pull.csv", "--template", "test_rig", *words)
    assert "validation" not in (own_folder / f"{rig}/case/{rig}.yaml").read_text()
    assert say("preprocess", "--config-dir", rig, f"case={rig}", "mlflow.enabled=false").code == 0


def test_uneven_stamps_are_resampled(say, own_folder, rig):
    t = 0.01 * np.arange(400) + 0.002 * (np.arange(400) % 3)
    rows = "\n".join(f"{a:.4f},{np.sin(a):.6f}" for a in t)
    (own_folder / "swing.csv").write_text(f"t,angle\n{rows}\n")
    said = say("new", rig, "--from", "swing.csv", "--template", "pendulum")
    assert "uneven: resampled to" in said.out
    assert signals_of(own_folder, rig)["resample"] == pytest.approx(0.01, rel=0.3)
    assert say("preprocess", "--config-dir", rig, f"case={rig}", "mlflow.enabled=false").code == 0


def test_the_stamps_of_a_video_are_resampled_at_its_rate(say, own_folder, rig):
    """Milliseconds, and a picture that was lost; with steps of 33 ms each sample would be interpolated."""
    t = np.delete(np.arange(400) / 30, 40)
    rows = "\n".join(f"{a:.3f},{np.sin(a):.6f}" for a in t)
    (own_folder / "swing.csv").write_text(f"t,angle\n{rows}\n")
    assert say("new", rig, "--from", "swing.csv", "--template", "pendulum").code == 0
    assert signals_of(own_folder, rig)["resample"] == pytest.approx(1 / 30, rel=1e-9)


def test_stamps_may_count_from_1970(say, rig, own_folder):
    t = 1.7e9 + 0.01 * np.arange(400)
    rows = "\n".join(f"{a:.2f},{np.sin(a):.6f}" for a in t)
    (own_folder / "swing.csv").write_text(f"t,angle\n{rows}\n")
    assert say("new", rig, "--from", "swing.csv", "--template", "pendulum").code == 0
    case = yaml.safe_load((own_folder / f"{rig}/case/{rig}.yaml").read_text())
    assert case["records"]["fitted"]["steps"] == [
        {"step": "crop", "stop": pytest.approx(1.7e9 + 2.79, abs=0.02)}
    ]
    assert say("preprocess", "--config-dir", rig, f"case={rig}", "mlflow.enabled=false").code == 0


TABLE = "t,a,b,still\n" + "\n".join(
    f"{0.01 * k},{np.sin(0.1 * k):.5f},{np.cos(0.3 * k):.5f},1" for k in range(200)
)
WITH_ZERO = TABLE.replace("\n", ",0\n").replace("still,0", "still,zero") + ",0"
FREE = ["--signal", "torque=none", "--signal", "angle=a"]
REFUSED = {
    "template": (["--template", "rotari"], "unknown template 'rotari': did you mean 'rotary'?"),
    "unknown signal": (["--signal", "angel=a"], "template rotary has no signal 'angel'; it has"),
    "unknown column": (["--signal", "angle=A1"], "there is no column 'A1'"),
    "column twice": (["--signal", "angle=a", "--signal", "torque=a"], "'a' is given for angle and torque"),
    "which columns": ([], "which column is torque, the torque of the drive; which is angle, the angle of"),
    "columns left": ([], "angle=COLUMN, or, if nothing drives it, --signal torque=none; columns left: a, b"),
    "needed": (["--signal", "angle=none"], "cannot do without the signal, only without torque; columns: a"),
    "hold of none": ([*FREE, "--hold", "torque=zoh"], "torque is none, so it has no scale and no hold"),
    "scale of none": ([*FREE, "--scale", "torque=2"], "torque is none, so it has no scale and no hold"),
    "always zero": (["--signal", "torque=zero", *FREE[2:]], "nothing drives it, give --signal torque=none"),
    "no number": (["--scale", "torque=much"], "--scale torque=much: it must be a number"),
    "zero": (["--scale", "torque=0"], "it must be a number, finite and not 0"),
    "no pair": (["--signal", "torque"], "--signal torque: write --signal SIGNAL=COLUMN"),
    "hold": (["--hold", "torque=steps"], "allowed: zoh, foh, bandlimited"),
    "hold of an output": (["--hold", "angle=zoh"], "'angle' is no input of template rotary"),
    "parameter": (["--constant", "K=still"], "unknown parameter of template rotary 'K'"),
    "no constant": (["--constant", "J=a", "--signal", "torque=b", "--signal", "angle=a"], "no constant"),
    "rate": (["--rate", "0"], "--rate is 0, it must be positive"),
    "flag": (["--signals", "torque=a"], "unrecognized arguments"),
    "constant": (["--signal", "torque=a", "--signal", "angle=still"], "signal angle never changes"),
    "time": (["--time", "b", "--signal", "torque=a", "--signal", "angle=t"], "do not advance"),
}  # fmt: skip


@pytest.mark.parametrize("wrong", REFUSED)
def test_what_is_wrong_costs_one_line_and_writes_nothing(wrong, say, own_folder, rig):
    (own_folder / "run.csv").write_text(WITH_ZERO if wrong == "always zero" else TABLE)
    words, line = REFUSED[wrong]
    template = [] if "--template" in words else ["--template", "rotary"]
    said = say("new", rig, "--from", "run.csv", *template, *words)
    assert said.code == 2
    assert line in said.complaint
    assert len(said.err.strip().splitlines()) == 1
    assert [path.name for path in own_folder.iterdir()] == ["run.csv"]


@pytest.mark.parametrize(
    ("name", "line"),
    [
        ("Rig", "small letters, digits and _"),
        ("json", "is already the name of a Python library"),
        ("emps", "is already the name of a case"),
        ("there", "exists already"),
        ("no/rig", "no: no such folder"),
    ],
)
def test_a_name_that_cannot_be_is_refused(name, line, recorded, say, own_folder):
    words = recorded("carriage")
    (own_folder / "there").mkdir()
    said = say("new", name, *words)
    assert said.code == 2
    assert line in said.complaint


def test_a_unit_of_another_quantity_needs_a_scale(recorded, say, rig):
    words = recorded("carriage")
    said = say("new", rig, *words[:4])
    assert said.complaint.endswith("column 'motor current [A]' in A: give --scale force=NUMBER, in N per A")


def test_all_scales_that_are_missing_are_asked_for_at_once(say, own_folder, rig):
    """A dryer: the voltage of its heater, and that of its thermocouple."""
    rows = "\n".join(f"{0.1 * k:.1f},{k % 3},{np.sin(k / 9):.4f}" for k in range(100))
    (own_folder / "dryer.csv").write_text(f"t [s],power [V],temp [V]\n{rows}\n")
    words = ("new", rig, "--from", "dryer.csv", "--template", "heater")
    said = say(*words)
    assert said.code == 2
    assert said.complaint.endswith(
        "signal power is in W, column 'power [V]' in V, and signal temperature is in °C, column 'temp [V]' "
        "in V: give --scale power=NUMBER, in W per V, and --scale temperature=NUMBER, in °C per V"
    )
    asked = ("--scale", "power=1", "--scale", "temperature=1")
    assert say(*words, *asked).code == 0


def test_a_speed_is_no_position_whatever_the_scale(say, own_folder, rig):
    (own_folder / "run.csv").write_text(TABLE.replace("a,b", "force,v_kmh", 1))
    words = ("--template", "carriage", "--signal", "position=v_kmh", "--scale", "position=0.2778")
    said = say("new", rig, "--from", "run.csv", *words)
    assert said.code == 2
    assert "signal position is in m, column 'v_kmh' in kmh: it is its rate of change" in said.complaint


def test_a_column_may_be_named_without_its_unit(say, own_folder, rig):
    """The header here has names and, in a second row, units: a user copies the names."""
    text = TABLE.replace("t,a,b,still\n", "Uhr;Strom;Temperatur;still\ns;%;°C;1\n").replace(",", ";")
    (own_folder / "run.csv").write_text(text)
    words = ("--template", "blank", "--signal", "input=Strom", "--signal", "output=Temperatur")
    said = say("new", rig, "--from", "run.csv", *words, "--time", "Uhr")
    assert said.code == 0
    assert "taken as recorded" in said.out
    case = (own_folder / rig / "case" / f"{rig}.yaml").read_text()
    assert 'column: "Temperatur [°C]", unit: "1"} # signal that is measured, in °C' in case


def test_recordings_that_are_no_measurements_are_marked(recorded, say, own_folder, rig):
    say("new", rig, *recorded("carriage"), "--simulated")
    assert "\n  simulated: true # no measurement" in (own_folder / rig / "case" / f"{rig}.yaml").read_text()
    said = say("fit", "--config-dir", rig, f"case={rig}", "out=tree", "mlflow.enabled=false")
    assert "Fit quality (simulated)" in said.out


def test_a_column_of_text_is_told_as_such(say, own_folder, rig):
    lines = [f'{{"ts": {0.01 * k}, "esc": {{"a": {k % 7}}}, "x": {k % 5}, "mode": "eco"}}' for k in range(60)]
    (own_folder / "run.jsonl").write_text("\n".join(lines))
    words = (rig, "--from", "run.jsonl", "--template", "rotary", "--signal")
    assert (
        "column 'mode' cannot be a signal: it holds the text 'eco'"
        in say("new", *words, "angle=mode").complaint
    )
    assert (
        "columns: esc.a, x; no numbers: mode (it holds the text 'eco' at sample 0"
        in say("new", *words, "angle=nothing").complaint
    )


def test_a_missing_recording_is_one_line(say, rig):
    assert (
        "nowhere.csv: no such file"
        in say("new", rig, "--from", "nowhere.csv", "--template", "tank").complaint
    )


@pytest.mark.parametrize(("typed", "column"), [("2\n", "b"), ("b\n", "b"), ("1\n", "a")])
def test_on_a_terminal_it_asks(typed, column, say, own_folder, monkeypatch, rig):
    class Screen(io.StringIO):
        def isatty(self):
            return True

    (own_folder / "run.csv").write_text(TABLE)
    monkeypatch.setattr(sys, "stdin", Screen(typed))
    screen = Screen()
    monkeypatch.setattr(sys, "stderr", screen)
    assert say("new", rig, "--from", "run.csv", "--template", "rotary").code == 0
    assert "Which column is torque" in screen.getvalue()
    assert signals_of(own_folder, rig)["inputs"]["torque"]["column"] == column


def test_the_template_is_asked_for_by_the_names_of_all(say, own_folder):
    said = say("new", "rig", "--from", "run.csv")
    assert said.code == 2
    assert f"--template is missing: {', '.join(kinds())}" in said.complaint


def test_a_recording_may_be_several_files(say, own_folder, rig):
    """Two loggers that were started together: each has a clock, and one has a column that the other has."""
    t = 0.01 * np.arange(400)
    for name, signal in (("drive", np.sign(np.sin(t))), ("encoder", np.sin(3 * t))):
        rows = "\n".join(f"{a:.2f},{b:.6f},{k}" for k, (a, b) in enumerate(zip(t, signal, strict=True)))
        label = {"drive": "torque", "encoder": "angle [deg]"}[name]
        (own_folder / f"{name}.csv").write_text(f"t,{label},count\n{rows}\n")
    assert say("new", rig, "--from", "drive.csv+encoder.csv", "--template", "rotary").code == 0
    assert signals_of(own_folder, rig)["time"] == {"column": "drive:t", "unit": "s", "same": ["encoder:t"]}
    said = say("preprocess", "--config-dir", rig, f"case={rig}", "mlflow.enabled=false")
    assert said.code == 0, said.err
    rows = (own_folder / "encoder.csv").read_text().replace("\n3.99,", "\n4.01,")
    (own_folder / "encoder.csv").write_text(rows)
    said = say("preprocess", "--config-dir", rig, f"case={rig}", "mlflow.enabled=false")
    assert "time columns 'drive:t' and 'encoder:t' differ: not recorded together" in said.complaint


def test_time_is_asked_for_by_its_options(say, own_folder):
    (own_folder / "run.csv").write_text(TABLE.replace("t,a", "clock1,a"))
    said = say("new", "rig", "--from", "run.csv", "--template", "rotary")
    assert "clock1 rises evenly, as time does. Give --time COLUMN, or --rate HZ" in said.complaint


def test_the_unit_of_the_stamps_is_taken_where_no_header_names_it(say, own_folder):
    (own_folder / "run.csv").write_text(TABLE)
    words = ("--from", "run.csv", "--template", "rotary", *FREE)
    said = say("new", "in_s", *words)
    assert "time: column t in s (assumed, else give --time-unit)" in said.out
    told = say("new", "in_ms", *words, "--time-unit", "ms")
    assert "time: column t in ms, " in told.out
    wrong = say("new", "rig", *words, "--time-unit", "sec")
    assert "--time-unit: unknown unit 'sec'" in wrong.complaint


def test_words_become_a_request():
    asked = _request(["rig", "--from", "a.csv", "b.csv+c.csv", "--template", "tank", "--rate", "2"])
    assert [[path.name for path in paths] for paths in asked.recordings] == [["a.csv"], ["b.csv", "c.csv"]]
    assert asked.rate == 2.0


def test_a_disk_that_is_full_leaves_nothing(recorded, say, rig, own_folder, monkeypatch):
    def write(path, text):
        if path.name == "README.md":
            raise OSError(errno.ENOSPC, "No space left on device", str(path))
        path.write_text(text)

    words = recorded("carriage")
    monkeypatch.setattr("pipelines.new.create.write_text", write)
    said = say("new", rig, *words)
    assert said.code == 1
    assert "no space left on device" in said.complaint
    assert len(said.err.strip().splitlines()) == 1
    assert [path.name for path in own_folder.iterdir()] == ["carriage.csv"]


@pytest.mark.parametrize(("oscillations", "by_parts"), [(3, True), (9, False)])
def test_a_short_decay_judges_with_parts_of_all(oscillations, by_parts, say, rig, own_folder):
    """Two swings about the same amplitude, of 20 oscillations and of few."""
    files = []
    for name, count in (("long", 20), ("last", oscillations)):
        t = np.arange(0.0, count, 0.05)
        swings = (1 + 0.3 * np.cos(t)) * np.cos(2 * np.pi * t)  # beats, so that amplitude is not time
        rows = "".join(f"{a:.2f},{b:.5f}\n" for a, b in zip(t, swings, strict=True))
        (own_folder / f"{name}.csv").write_text(f"t [s],displacement [m]\n{rows}")
        files.append(f"{name}.csv")
    say("new", rig, "--from", *files, "--template", "oscillator", "--signal", "force=none")
    case = yaml.safe_load((own_folder / f"{rig}/case/{rig}.yaml").read_text())
    assert ("trace" in case) is by_parts
