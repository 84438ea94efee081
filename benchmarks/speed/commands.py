"""What the commands themselves take: help, a config, a warm fit, a run with its figures."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory

from benchmarks.speed.row import OURS, Row

COMMANDS = "commands"
SHORT = ("case=emps", "data=simulated", "rig.duration=8.0")


def commands(repeats: int, say: Callable[[str], None], quick: bool) -> Iterator[Row]:
    """Wall time of whole processes, one after another."""
    with TemporaryDirectory() as folder:
        out = (f"paths.outputs={folder}", "mlflow.enabled=false")
        yield _timed("hybridid --help", ["--help"], repeats, say)
        yield _timed("hybridid fit --cfg job", ["fit", "case=emps", "--cfg", "job"], repeats, say)
        fit = ["fit", *SHORT, *out, "force=true"]
        _seconds(fit)  # what is compiled is kept
        row = _timed("hybridid fit, 8 s of record, warm", fit, repeats, say)
        row.details["in the solver"] = _solver(Path(folder))
        yield row
        if not quick:
            run = ["run", *SHORT, *out, "force=true"]
            yield _timed("hybridid run, 2 records, with figures", run, 1, say)


def _timed(what: str, words: Sequence[str], repeats: int, say: Callable[[str], None]) -> Row:
    seconds = tuple(_seconds(words) for _ in range(repeats))
    row = Row(
        COMMANDS, what, OURS, seconds, "exit code 0", "simulated" if "data=simulated" in words else "none"
    )
    say(f"{what}: {row.median:.2f} s")
    return row


def _seconds(words: Sequence[str]) -> float:
    """Wall seconds of ``hybridid WORDS``.

    Raises:
        RuntimeError: if the command fails.
    """
    began = time.perf_counter()
    done = subprocess.run(
        [sys.executable, "-m", "hybridid_cli", *words],
        capture_output=True, text=True, check=False, env={**os.environ, "OMP_NUM_THREADS": "1"},
    )  # fmt: skip
    if done.returncode:
        raise RuntimeError(f"hybridid {' '.join(words)}: {done.stderr.strip()[-500:]}")
    return time.perf_counter() - began


def _solver(folder: Path) -> float:
    """Seconds that the last fit spent in building and solving its problem."""
    newest = max(folder.glob("*/*/fit/estimate.json"), key=os.path.getmtime)
    seconds = json.loads(newest.read_text())["seconds"]
    return float(sum(seconds.values()))
