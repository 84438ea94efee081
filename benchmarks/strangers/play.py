"""One machine from its recording to a traced report: commands alone, each a process as a user starts it."""

from __future__ import annotations

import json
import os
import resource
import subprocess
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from benchmarks.strangers.machines import MACHINES
from benchmarks.strangers.recording import Simulated
from benchmarks.strangers.rigs import free_swing, gap_damper, three_swings
from benchmarks.strangers.tanks import overflowing

ROOT = Path(__file__).resolve().parents[2]
SECONDS = 20.0
"""Of each recording at 500 Hz: 10,000 samples."""


@dataclass(frozen=True)
class Machine:
    """A recording to be made, and the template that a user would take for it."""

    name: str
    template: str
    record: Callable[[], Simulated]


RIGS = (
    Machine("gap_damper", "test_rig", gap_damper),
    Machine("free_swing", "pendulum", free_swing),
    Machine("three_swings", "pendulum", three_swings),
    Machine("overflowing", "two_tanks", overflowing),
)
"""Machines that lack what their template declares."""


@dataclass(frozen=True)
class Outcome:
    """What came of a machine. ``wall`` and ``cpu`` are the times of ``new``, ``run`` and ``trace`` in s;
    ``off`` is the largest relative error of a planted parameter that the traced model has."""

    machine: str
    template: str
    wall: tuple[float, ...]
    cpu: tuple[float, ...]
    sentence: str
    off: float | None
    parameter: str


def machines() -> tuple[Machine, ...]:
    """Each template's machine, where nothing is missing; a slide that lacks an effect; and ``RIGS``."""
    known = {"slide": "carriage"}
    made = (Machine(name, known.get(name, name), partial(_recorded, name)) for name in MACHINES)
    return (*made, *RIGS)


def _recorded(name: str) -> Simulated:
    """As many samples as ``SECONDS`` have at 500 Hz: tanks are sampled at 1 Hz."""
    return MACHINES[name](500 * SECONDS if "tank" in name else SECONDS)


def played(machine: Machine, folder: Path) -> Outcome:
    """Write the recording of ``machine`` to ``folder``, and run the commands of the page there.

    Raises:
        RuntimeError: if a command fails, with what it said.
    """
    made = machine.record()
    name = f"my_{machine.name}"
    files = [f"{machine.name}{k or ''}.csv" for k in range(1 + len(made.more))]
    for file, text in zip(files, (made.text, *made.more), strict=True):
        (folder / file).write_text(text, encoding="utf-8")
    case = ("--config-dir", name, f"case={name}", *made.settings)
    lines = (
        ("new", name, "--from", *files, "--template", machine.template, *made.words),
        ("run", *case),
        ("trace", *case),
    )
    times = [_timed(line, folder) for line in lines]
    (trace,) = folder.glob(f"outputs/{name}/latest/trace/trace.json")
    found = json.loads(trace.read_text())
    sentence, values = found["sentence"], _values(found["estimates"])
    errors = {p: abs(values[p] - t) / abs(t or 1.0) for p, t in made.truth.items() if p in values}
    worst = max(errors, key=lambda p: errors[p], default="")
    wall, cpu = zip(*times, strict=True)
    return Outcome(machine.name, machine.template, wall, cpu, sentence, errors.get(worst), worst)


def _values(estimates: dict[str, dict[str, dict[str, float]]]) -> dict[str, float]:
    """The parameters of the traced model, by name."""
    return {name: one["value"] for name, one in estimates["after"].items()}


def _timed(words: tuple[str, ...], folder: Path) -> tuple[float, float]:
    """Wall and CPU time in s of ``hybridid`` with ``words``."""
    environment = {k: v for k, v in os.environ.items() if k != "HYBRIDID_DATA"} | {"PYTHONPATH": str(ROOT)}
    begun, used = time.monotonic(), _used()
    done = subprocess.run(
        [sys.executable, "-m", "hybridid_cli", *words],
        cwd=folder, env=environment, capture_output=True, text=True, stdin=subprocess.DEVNULL,
    )  # fmt: skip
    if done.returncode not in (0, 3):
        raise RuntimeError(f"hybridid {' '.join(words)}: {done.stderr}")
    return time.monotonic() - begun, _used() - used


def _used() -> float:
    """CPU time in s of all processes that this one has started and seen end."""
    ended = resource.getrusage(resource.RUSAGE_CHILDREN)
    return ended.ru_utime + ended.ru_stime
