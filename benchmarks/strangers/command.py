"""A command of hybridid in a process of its own, as a user starts it, and the lines of Python in a folder."""

from __future__ import annotations

import difflib
import os
import subprocess
import sys
import time
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from benchmarks.studies import cpu_seconds

ROOT = Path(__file__).resolve().parents[2]
DATA = "HYBRIDID_DATA"
"""The variable that names the folder of the measured records."""
DONE = (0, 3)
"""Exit codes of a command that did its work; 3: the trace found something that it cannot name."""


@dataclass(frozen=True)
class Took:
    """Wall and CPU time of a command in s, and what it said."""

    wall: float
    cpu: float
    said: str


def commanded(words: tuple[str, ...], folder: Path) -> Took:
    """Run ``hybridid`` with ``words`` in ``folder``, without the measured records.

    Raises:
        RuntimeError: if it fails, with what it said.
    """
    begun, used = time.monotonic(), cpu_seconds()
    done = subprocess.run(
        [sys.executable, "-m", "hybridid_cli", *words],
        cwd=folder, env=environment(), capture_output=True, text=True, stdin=subprocess.DEVNULL,
    )  # fmt: skip
    if done.returncode not in DONE:
        raise RuntimeError(f"hybridid {' '.join(words)}: {done.stderr}")
    return Took(time.monotonic() - begun, cpu_seconds() - used, done.stdout)


def environment(more: Mapping[str, str] | None = None) -> dict[str, str]:
    """This process's environment with this code and without the measured records, and ``more``."""
    kept = {name: value for name, value in os.environ.items() if name != DATA}
    return {**kept, "PYTHONPATH": str(ROOT), **(more or {})}


def python_in(folder: Path) -> dict[str, list[str]]:
    """The lines of each Python file below ``folder``, by its name."""
    return {str(f.relative_to(folder)): f.read_text().splitlines() for f in sorted(folder.rglob("*.py"))}


def beyond(before: Mapping[str, list[str]], after: Mapping[str, list[str]]) -> int:
    """How many lines of ``after`` do not stand in ``before``: those that were written or changed."""
    changed = (
        line
        for name, lines in after.items()
        for line in difflib.unified_diff(before.get(name, []), lines, n=0, lineterm="")
    )
    return sum(line.startswith("+") and not line.startswith("+++") for line in changed)
