"""Completion in a real bash, on a real terminal: words typed, TAB pressed."""

from __future__ import annotations

import os
import pty
import re
import select
import shutil
import signal
import sys
import time
from pathlib import Path

import pytest

from hybridid.effects.library import EFFECTS
from hybridid_cli.commands import BY_NAME
from hybridid_cli.completion import candidates
from hybridid_cli.config_files import conf_folder

pytestmark = pytest.mark.skipif(shutil.which("bash") is None, reason="needs bash")


CASES = {f"case={path.stem}" for path in (conf_folder() / "case").glob("*.yaml")}


class Bash:
    """An interactive bash that has ``hybridid`` on its path and its completion loaded."""

    def __init__(self, folder: Path, environment: dict[str, str]) -> None:
        command = folder / "bin" / "hybridid"
        command.parent.mkdir()
        command.write_text(f'#!/bin/sh\nexec "{sys.executable}" -m hybridid_cli "$@"\n')
        command.chmod(0o755)
        (folder / "rc").write_text(
            'PS1="READY> "\nbind "set bell-style none"\nbind "set enable-bracketed-paste off"\n'
            'bind "set show-all-if-ambiguous on"\nbind "set page-completions off"\n'
            'bind "set completion-query-items 0"\n'
            'eval "$(hybridid completion bash)"\n'
        )
        path = f"{command.parent}{os.pathsep}{environment['PATH']}"
        self.pid, self.terminal = pty.fork()
        if self.pid == 0:
            os.chdir(folder)
            os.execvpe(
                "bash",
                ["bash", "--noprofile", "--rcfile", "rc", "-i"],
                {**environment, "PATH": path, "TERM": "dumb", "COLUMNS": "400"},
            )
        self.read_until("READY> ")

    def read_until(self, wanted: str, patience: float = 30.0) -> str:
        text, end = "", time.monotonic() + patience
        while time.monotonic() < end:
            ready, _, _ = select.select([self.terminal], [], [], 0.1)
            if ready:
                text += os.read(self.terminal, 65536).decode(errors="replace")
                if wanted in text:
                    return text
        raise AssertionError(f"{wanted!r} never came; bash said {text!r}")

    def tab(self, typed: str, wanted: str) -> str:
        """Type, press TAB, wait for ``wanted``; then clear the line. Returns what came."""
        os.write(self.terminal, typed.encode() + b"\t")
        text = self.read_until(wanted)
        os.write(self.terminal, b"\x15\n")  # drop the line, ask for a new prompt
        self.read_until("READY> ")
        return text

    def close(self) -> None:
        os.kill(self.pid, signal.SIGKILL)
        os.waitpid(self.pid, 0)
        os.close(self.terminal)


@pytest.fixture
def bash(tmp_path, environment):
    shell = Bash(tmp_path, environment)
    yield shell
    shell.close()


def test_bash_completes_what_is_typed(bash, tmp_path):
    """Commands, keys up to the dot, values behind '=', effects inside a list, a user's own case."""
    (tmp_path / "mylab" / "case").mkdir(parents=True)
    (tmp_path / "mylab" / "case" / "mine.yaml").write_text("# @package _global_\nspecial: {key: 1}\n")
    bash.tab("hybridid pre", "hybridid preprocess ")
    bash.tab("hybridid fit cas", "case")
    bash.tab("hybridid fit case=em", "case=emps ")
    bash.tab("hybridid fit estimator=mult", "estimator=multiple_shooting ")
    bash.tab("hybridid fit estimator.hor", "estimator.horizon=")
    bash.tab("hybridid fit parameters.carriage.coul", "parameters.carriage.coulomb.")
    bash.tab("hybridid fit effects=[viscous,coul", "effects=[viscous,coulomb")
    bash.tab("hybridid fit --config-dir mylab case=mi", "case=mine ")
    bash.tab("hybridid fit --config-dir mylab case=mine spec", "special.")
    bash.tab("hybridid effects asymmetric_v", "asymmetric_viscous ")
    listed = bash.tab("hybridid fit data=", "simulated")
    assert {"auto", "measured", "simulated"} <= set(re.findall(r"\w+", listed))
    listed = bash.tab("hybridid ", "validate")
    assert set(BY_NAME) <= set(re.findall(r"\w+", listed))


@pytest.mark.parametrize(
    ("line", "offered"),
    [
        ("hybridid fi", {"fit"}),
        ("hybridid fit case=", CASES),
        (
            "hybridid fit validate.",
            {f"validate.{k}=" for k in ("horizon", "initial_state", "lags", "records", "views")},
        ),
        ("hybridid fit validate.initial_state=m", {"validate.initial_state=measured"}),
        (
            "hybridid fit estimator.integrator=",
            {f"estimator.integrator={k}" for k in ("auto", "rk4", "rodas3")},
        ),
        ("hybridid fit trace.held_out=", {"trace.held_out=auto", "trace.held_out=null"}),
        ("hybridid fit mlflow.enabled=", {"mlflow.enabled=true", "mlflow.enabled=false"}),
        ("hybridid fit --cfg ", {"job", "hydra", "all"}),
        (
            "hybridid fit parameters.M.",
            {f"parameters.M.{k}=" for k in ("guess", "lower", "upper", "fixed", "by")},
        ),
        ("hybridid fetch ", {"emps"}),
        ("hybridid cases em", {"emps"}),
        ("hybridid completion ", {"bash"}),
        ("hybridid new my_rig --template ro", {"room", "rotary"}),
        ("hybridid new my_rig --t", {"--template", "--time", "--time-unit"}),
        ("hybridid new my_rig --from ", set()),
        ("hybridid effects ", {effect.id for effect in EFFECTS}),
        ("hybridid fit effects=[viscous,visc", set()),
        ("hybridid nonsense ", set()),
    ],
)
def test_candidates(line, offered):
    found = set(candidates(line))
    assert offered <= found
    if not line.endswith(" "):
        assert found == offered


def test_unknown_shell(say):
    said = say("completion", "bsh")
    assert said.code == 2
    assert "did you mean 'bash'?" in said.err


def test_completion_is_fast(process):
    """The pause after TAB; the best of some tries, for the machine may be busy."""
    durations = []
    for _ in range(6):
        began = time.perf_counter()
        process("completion", "words", "hybridid fit estimator.")
        durations.append(time.perf_counter() - began)
    assert min(durations) < 0.5
