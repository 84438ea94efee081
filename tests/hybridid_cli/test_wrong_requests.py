"""A wrong request costs one line, with the nearest right name and what is allowed, and writes nothing."""

from __future__ import annotations

from pathlib import Path

import pytest

from hybridid_cli.tasks import Unfinished

# words after `fit`, what the line must hold
WRONG = (
    (["case=emp"], ["unknown case 'emp'", "did you mean 'emps'?"]),
    (["cas=emps"], ["unknown config key 'cas'", "did you mean 'case'?"]),
    (["estimator.horzon=3"], ["did you mean 'estimator.horizon'?", "estimator.interval"]),
    (["estimator=gaus_newton"], ["unknown estimator", "did you mean 'gauss_newton'?", "multiple_shooting"]),
    (["estimator.horizon=abc"], ["estimator.horizon is 'abc'", "number"]),
    (["estimator.horizon=1.5"], ["estimator.horizon is 1.5", "whole number"]),
    (["estimator.method=newton"], ["estimator.method is 'newton'", "gauss_newton, multiple_shooting"]),
    (["effects=[viscos]"], ["unknown effect 'viscos'", "did you mean 'viscous'?", "coulomb"]),
    (["effects=[viscous@carrige]"], ["carrige", "did you mean 'carriage'?"]),
    (["effects=[viscous,viscous]"], ["carriage.viscous", "twice"]),
    (["effects=viscous"], ["give a list", "effects=[viscous"]),
    (["effects=[nowhere:EFFECT]"], ["nowhere:EFFECT", "No module named"]),
    (["plant=hybridid.plants.emps:EMSP"], ["did you mean 'EMPS'?"]),
    (["parameters.MM.lower=3"], ["unknown parameter 'MM'", "did you mean 'M'?"]),
    (
        ["parameters.M.lowr=3"],
        ["setting of parameter M", "did you mean 'lower'?", "guess, lower, upper, fixed"],
    ),
    (["parameters.M.lower=low"], ["parameters.M.lower is 'low'", "number"]),
    (["parameters={MM: {lower: 3}}"], ["unknown parameter 'MM'", "did you mean 'M'?"]),
    (["parameters=3"], ["parameters is 3", "guess, lower, upper, fixed", "{M: {lower: 1.0}}"]),
    (["force=no"], ["force is 'no': expected true or false"]),
    (["mlflow.enabled=off"], ["mlflow.enabled is 'off': expected true or false"]),
    (["mlflow.enabled=1"], ["mlflow.enabled is 1: expected true or false"]),
    (["validate.horizon=-1"], ["validate.horizon is -1"]),
    (["out=''"], ["out is '': give DIR"]),
    (["estimator=3"], ["unknown estimator '3': allowed: gauss_newton"]),
    (["estimator=null"], ["unknown estimator 'null': allowed: gauss_newton"]),
    (["residual.kind=rbf"], ["no residual is chosen", "residual=narx|narx_esea|rbf"]),
    (["+residual.judged=no", "residual=rbf"], ["residual.judged is in the config already", "without +"]),
    (["preprocess.steps=3"], ["preprocess.steps is 3: give a list of steps"]),
    (["rig.sede=3"], ["unknown config key below rig 'sede'", "did you mean 'seed'?"]),
    (["signals.inputs.force.hold=foo"], ["inputs.force: hold is 'foo'", "zoh, foh, bandlimited"]),
    (["parameters.M=3"], ["parameters.M is 3", "guess, lower, upper, fixed"]),
    (["parameters.M.lower=200"], ["M", "200", "150"]),
    (["parameters.carriage.viscous.fv.guess=3"], ["did you mean 'carriage.viscous.f_v'?"]),
    (["data=simulate"], ["did you mean 'simulated'?", "auto, measured, simulated"]),
    (["fit.records=[identificaton]"], ["fit.records", "did you mean 'identification'?"]),
    (["preprocess.steps=[{step: decimat}]"], ["unknown step 'decimat'", "did you mean 'decimate'?"]),
    (["estimator.horizon=1,2"], ["add -m", "estimator.horizon=[1,2]"]),
    (["emps"], ["did you mean case=emps?"]),
    (["x" * 3000], ["xx ... xx", "xx' is no key=value, as in"]),
    (["--cgf", "job"], ["unknown flag '--cgf'", "did you mean '--cfg'?"]),
    (["--cfg", "jbo"], ["unknown value of --cfg 'jbo'", "did you mean 'job'?"]),
    (["--config-dir"], ["--config-dir wants a value"]),
    (["--config-dir", "nowhere"], ["nowhere", "not found"]),
    (["a=["], ["cannot read 'a=['"]),
    (["+extra=1"], ["unknown config key 'extra'"]),
    (["paths.data=nowhere", "data=auto"], ["paths.data is nowhere: no such folder"]),
    (["rig.path=hybridid.rigs.emps:Rigg"], ["rig.path", "did you mean 'EMPSRig'?"]),
)


@pytest.mark.parametrize(("words", "expected"), WRONG, ids=[" ".join(words) for words, _ in WRONG])
def test_one_line_that_helps(say, quick, words, expected):
    said = say("fit", *quick, *words)
    assert said.code == 2
    assert said.out == ""
    assert said.err.startswith("hybridid: ")
    assert said.err.count("\n") == 1, said.err
    for part in expected:
        assert part in said.err
    assert list(Path().iterdir()) == [], "something was written"


@pytest.mark.parametrize(
    ("words", "expected"),
    [
        (["validate.views=[free]"], "did you mean 'free_run'?"),
        (["validate.views=[]"], "validate.views is []"),
        (["validate.horizon=-1"], "validate.horizon is -1"),
        (["validate.initial_state=guess"], "estimated, measured"),
        (["validate.records=[vaildation]"], "did you mean 'validation'?"),
        (["validate.horzion=2"], "did you mean 'validate.horizon'?"),
    ],
)
def test_wrong_validation_is_said_before_the_fit(say, quick, words, expected):
    said = say("run", *quick, *words)
    assert said.code == 2
    assert expected in said.complaint
    assert list(Path().iterdir()) == []


def test_key_that_another_command_would_take_is_unknown_here(say, quick):
    assert say("fit", *quick, "port=80").code == 2


def test_no_measured_record_where_one_is_insisted_on(say):
    said = say("fit", "case=emps", "data=measured", "mlflow.enabled=false")
    assert said.code == 1
    assert said.err.count("\n") == 1
    assert "DATA_EMPS.mat not found" in said.err
    assert "hybridid fetch emps" in said.err
    assert list(Path().iterdir()) == []


def test_traceback_only_on_request(say, process, quick, monkeypatch):
    words = ("fit", *quick, "effects=[viscos]")
    assert "Traceback" not in say(*words).err
    asked = process(*words, "--debug")
    assert asked.code != 0
    assert "Traceback" in asked.err
    assert "unknown effect 'viscos'" in asked.err
    monkeypatch.setenv("HYDRA_FULL_ERROR", "1")
    with pytest.raises(Unfinished, match="unknown effect 'viscos'"):
        say(*words)


def test_parameters_as_a_whole_are_taken(say, quick):
    words = (
        "preprocess",
        *quick,
        "--cfg",
        "job",
        "parameters={M: {lower: 40}, carriage.viscous: {f_v: {upper: 9}}}",
    )
    said = say(*words)
    assert said.code == 0, said.err
    assert "lower: 40" in said.out


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("# @package _global_\ncase:\n\ttitle: x\n", "mine.yaml, line 3: found character '\\t'"),
        ("# @package _global_\nplant: a\nplant: b\n", "mine.yaml, line 3: found duplicate key plant"),
        ("# @package _global_\nplant: ${nothing}\n", "plant: Interpolation key 'nothing' not found"),
        (b"# @package _global_\ncase: \xff\xfe\n", "mine.yaml: not UTF-8 text"),
    ],
)
def test_a_case_file_that_cannot_be_read_is_one_line(say, own_folder, text, said):
    (own_folder / "lab" / "case").mkdir(parents=True)
    path = own_folder / "lab" / "case" / "mine.yaml"
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    answer = say("fit", "--config-dir", "lab", "case=mine", "mlflow.enabled=false")
    assert answer.code == 2
    assert answer.err.count("\n") == 1
    assert said in answer.complaint


@pytest.mark.parametrize(
    ("out", "said"),
    [
        ("file/below", "not a directory"),
        ("/proc/nowhere", "no such file or directory"),
        ("x" * 300, "too long"),
    ],
)
def test_a_folder_that_cannot_be_written_is_one_line(say, quick, own_folder, out, said):
    (own_folder / "file").write_text("")
    answer = say("preprocess", *quick, f"out={out}")
    assert answer.code == 1
    assert said in answer.complaint
    assert "--debug" not in answer.complaint
    assert answer.complaint.startswith(f"hybridid: {out[:40]}")
