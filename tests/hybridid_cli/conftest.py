"""The terminal, typed into: in this process where that is enough, in one of its own where it is not."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import pytest

from hybridid_cli.main import dispatch

ROOT = Path(__file__).parents[2]
# a short record of the virtual rig, nothing logged: what most tests of the terminal need
QUICK = ("case=emps", "data=simulated", "rig.duration=1.2", "mlflow.enabled=false")


@dataclass(frozen=True)
class Said:
    code: int
    out: str
    err: str

    @property
    def complaint(self) -> str:
        """The last line on stderr: what went wrong."""
        return self.err.strip().splitlines()[-1] if self.err.strip() else ""


@pytest.fixture
def say(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> Callable[..., Said]:
    """``say("fit", "case=emps")`` is ``hybridid fit case=emps`` without the start of a process."""
    monkeypatch.delenv("HYBRIDID_DATA", raising=False)

    def typed(*words: str) -> Said:
        capsys.readouterr()
        code = dispatch(words)
        said = capsys.readouterr()
        return Said(code, said.out, said.err)

    return typed


@pytest.fixture
def environment() -> dict[str, str]:
    """For processes of their own: they find the checkout, and no measured records."""
    kept = {k: v for k, v in os.environ.items() if k != "HYBRIDID_DATA"}
    return {**kept, "PYTHONPATH": str(ROOT)}


@pytest.fixture
def process(environment: dict[str, str]) -> Callable[..., Said]:
    """``hybridid`` in a process of its own."""

    def started(*words: str, **more: str) -> Said:
        done = subprocess.run(
            [sys.executable, "-m", "hybridid_cli", *words],
            env={**environment, **more},
            capture_output=True,
            text=True,
            stdin=subprocess.DEVNULL,
            timeout=300,
        )
        return Said(done.returncode, done.stdout, done.stderr)

    return started


@pytest.fixture
def quick() -> tuple[str, ...]:
    return QUICK
