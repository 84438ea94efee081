"""A trace that is killed at a random moment and started again, over and over. Simulated.

Each trial begins with the same fit. ``SIGKILL`` ends the trace at a random share of its refits, and within a
refit at a random part of its time, so that the load of the machine decides nothing. It can put nothing in
order. The same command then runs to its end. Each refit that begins is counted: what both traces began, less
what one that is left in peace begins, was done twice.
"""

from __future__ import annotations

import json
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from benchmarks.strangers.command import DONE, commanded, environment
from benchmarks.strangers.machines import slide
from benchmarks.torture import whole

SEED, KILLS = 19, 8
SECONDS = 10.0
"""Of the recording."""
EFFECTS = "asymmetric_viscous,asymmetric_coulomb,stribeck,quadratic_drag,dahl,linear_stiffness,end_stop"
NAME = "my_slide"
REFITS, SAID = "refits.txt", "said.txt"
CASE = ("--config-dir", NAME, f"case={NAME}", "mlflow.enabled=false")
TRACE = ("trace", *CASE, f"trace.effects=[{EFFECTS}]", "trace.processes=1")


@dataclass(frozen=True)
class Trial:
    """A kill: after a ``share`` of a trace's refits; the refits that had begun ``before`` it and those
    ``after`` it; whether verdict and numbers are the same."""

    share: float
    before: int
    after: int
    same_verdict: bool
    same_numbers: bool
    ended_before: bool = False


@dataclass(frozen=True)
class Killed:
    """All trials, beside a trace that nothing disturbed, of so many ``refits``."""

    refits: int
    seconds: float
    sentence: str
    trials: tuple[Trial, ...]

    def twice(self, trial: Trial) -> int:
        """How many refits were done twice."""
        return trial.before + trial.after - self.refits

    @property
    def struck(self) -> tuple[Trial, ...]:
        """The trials whose trace had not ended by itself before the kill."""
        return tuple(one for one in self.trials if not one.ended_before)


def played(folder: Path, kills: int = KILLS) -> Killed:
    """Fit, trace in peace, then kill and start again as often as asked.

    Raises:
        RuntimeError: if a command that nothing disturbs fails.
    """
    made = slide(SECONDS)
    (folder / "slide.csv").write_text(made.text, encoding="utf-8")
    commanded(
        ("new", NAME, "--from", "slide.csv", "--template", "carriage", *made.words, "--simulated"), folder
    )
    commanded(("fit", *CASE), folder)
    before = folder.with_name(f"{folder.name}-before")
    shutil.copytree(folder, before, symlinks=True)
    _finished(folder, _begun(folder))  # compiles what the others find compiled
    _restored(folder, before)
    running = _begun(folder)
    _refit(folder, running, 1)
    began = time.monotonic()
    _finished(folder, running)
    seconds = time.monotonic() - began
    refits, numbers, sentence = _count(folder), whole.numbers(folder), _sentence(folder)
    generator = np.random.default_rng(SEED)
    trials = []
    for share in generator.uniform(size=kills):
        _restored(folder, before)
        ended, first = _struck(folder, float(share) * refits, seconds / max(refits, 1))
        (folder / REFITS).unlink()
        _finished(folder, _begun(folder))
        again = _count(folder)
        same = _sentence(folder) == sentence, whole.numbers(folder) == numbers
        trials.append(Trial(float(share), first, again, *same, ended))
    shutil.rmtree(before)
    return Killed(refits, seconds, sentence, tuple(trials))


def _struck(folder: Path, at: float, each: float) -> tuple[bool, int]:
    """Kill a trace ``at`` so many refits, of about ``each`` s; whether it had ended, and the refits."""
    running = _begun(folder)
    _refit(folder, running, 1 + int(at))
    try:
        running.wait(at % 1.0 * each)
    except subprocess.TimeoutExpired:
        running.send_signal(signal.SIGKILL)
        running.wait()
        return False, _count(folder)
    return True, _count(folder)


def _begun(folder: Path) -> subprocess.Popen[bytes]:
    """The trace, started, with a cache of its own."""
    words = [sys.executable, "-m", "benchmarks.strangers.counted", str(folder / REFITS), *TRACE]
    own = environment({"XDG_CACHE_HOME": str(folder.with_name(f"{folder.name}-cache"))})
    with (folder / SAID).open("wb") as said:
        return subprocess.Popen(
            words, cwd=folder, env=own, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=said
        )


def _finished(folder: Path, running: subprocess.Popen[bytes]) -> None:
    if running.wait() not in DONE:
        raise RuntimeError(f"hybridid {' '.join(TRACE)}: {(folder / SAID).read_text()}")


def _refit(folder: Path, running: subprocess.Popen[bytes], number: int) -> None:
    """Wait until the trace begins its refit of this number, or ends."""
    while _count(folder) < number and running.poll() is None:
        time.sleep(0.005)


def _count(folder: Path) -> int:
    file = folder / REFITS
    return len(file.read_text().splitlines()) if file.exists() else 0


def _sentence(folder: Path) -> str:
    found: Mapping[str, str] = json.loads(
        (folder / "outputs" / NAME / "latest" / "trace" / "trace.json").read_text()
    )
    return found["sentence"]


def _restored(folder: Path, before: Path) -> None:
    """Make the folder as it was before the trace."""
    for path in folder.iterdir():
        shutil.rmtree(path) if path.is_dir() and not path.is_symlink() else path.unlink()
    shutil.copytree(before, folder, symlinks=True, dirs_exist_ok=True)
