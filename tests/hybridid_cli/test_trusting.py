"""``hybridid trust``, and the question whether code of a received file may run."""

from __future__ import annotations

import io
import json
import sys
from pathlib import Path

import pytest

from hybridid_cli import trusting
from hybridid_cli.launching import job
from pipelines.shared.config import Settings
from pipelines.shared.errors import ConfigError
from pipelines.shared.trust import Untrusted, is_trusted


@pytest.fixture
def theirs(own_folder, monkeypatch):
    monkeypatch.setenv("XDG_CONFIG_HOME", str(own_folder / "config"))
    folder = own_folder / "theirs"
    folder.mkdir()
    (folder / "evil_of_test.py").write_text(f"open({str(own_folder / 'ran')!r}, 'w')")
    return folder


@pytest.fixture
def answer(monkeypatch):
    """A terminal on which somebody types."""

    class Screen(io.StringIO):
        def isatty(self):
            return True

    def typed(text):
        screen = Screen()
        monkeypatch.setattr(sys, "stdin", Screen(text))
        monkeypatch.setattr(sys, "stderr", screen)
        return screen

    return typed


def test_a_folder_is_trusted_listed_and_trusted_no_more_after_a_change(say, theirs):
    assert "is no longer trusted" in say("trust").out
    said = say("trust", "theirs")
    assert said.code == 0
    assert f"trusted: {theirs}, 1 file of code, until one of them changes" in said.out
    assert f"{theirs}  " in say("trust").out
    assert "changed since" not in say("trust").out
    (theirs / "evil_of_test.py").write_text("")
    assert "changed since: no longer trusted" in say("trust").out


@pytest.mark.parametrize(("words", "line"), [(["nowhere"], "no such folder"), (["--all"], "is no folder")])
def test_what_is_no_folder_is_one_line(say, theirs, words, line):
    said = say("trust", *words)
    assert said.code == 2
    assert line in said.complaint


def test_without_a_terminal_nothing_is_asked(say, theirs, own_folder):
    model = {
        "case": "emps",
        "config": {"plant": "evil_of_test:X", "channels": None, "effects": [], "parameters": {}},
        "python_folders": [str(theirs)], "states": [], "inputs": [], "outputs": [], "terms": [],
        "provenance": "measured",
    }  # fmt: skip
    (theirs / "model.json").write_text(json.dumps(model))
    said = say("fit", "case=emps", "data=simulated", "model=theirs/model.json", "mlflow.enabled=false")
    assert said.code == 2
    assert len(said.err.strip().splitlines()) == 1
    assert f"names evil_of_test:X, code in {theirs}, which you do not trust" in said.complaint
    assert f"hybridid trust {theirs}" in said.complaint
    assert not (own_folder / "ran").exists()


@pytest.mark.parametrize(
    ("typed", "yes"), [("y\n", True), ("yes\n", True), ("n\n", False), ("\n", False), ("", False)]
)
def test_on_a_terminal_it_is_asked_once(theirs, answer, typed, yes):
    screen = answer(typed)
    asking = Untrusted("model is m.json: it", "evil_of_test:X", theirs)
    assert trusting.trusted_when_asked(asking) is yes
    assert f"names code in {theirs}: evil_of_test.py." in screen.getvalue()
    assert is_trusted(theirs) is yes


def test_a_job_file_runs_no_code_that_its_command_does_not_name(theirs, own_folder):
    """Its folders are only a claim."""
    config = {"case": {}, "plant": "evil_of_test:X", "effects": [], "mlflow": {"enabled": False}}
    point = {"case": "emps", "config": config, "folders": [str(theirs)], "at": {}}
    Path("job.json").write_text(json.dumps({"name": "j", "points": [point], "gray": True, "sweep": "s"}))
    own = Settings("emps", {"plant": "hybridid.plants.emps:EMPS", "effects": []})
    with pytest.raises(ConfigError, match=r"job is job\.json: it names evil_of_test:X, which is neither"):
        job(Path("job.json"), own, None)
    assert not (own_folder / "ran").exists()
