"""The terminal, typed into: in this process where that is enough, in one of its own where it is not."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

import pytest
from hydra._internal.hydra import Hydra
from omegaconf import OmegaConf

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


@pytest.fixture(scope="session", autouse=True)
def composed_once() -> Iterator[None]:
    """Hydra composes each config twice, the first time only to ask for ``hydra.mode``, which is null unless a
    word sets it, and parses the same files for each. In this process no config is composed for that, and a
    text is parsed once: half of what a refused request takes. Processes of their own do all of it."""
    asked, read, parsed = Hydra.get_mode, OmegaConf.load, dict[str, object]()

    def mode(hydra, config_name, overrides):
        return asked(hydra, config_name, overrides) if any("hydra" in word for word in overrides) else None

    def load(file):
        if not hasattr(file, "read"):
            return read(file)
        text = file.read()
        if text not in parsed:
            file.seek(0)
            parsed[text] = OmegaConf.to_container(read(file))
        return OmegaConf.create(parsed[text])

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(Hydra, "get_mode", mode)
        patch.setattr(OmegaConf, "load", staticmethod(load))
        yield


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
