"""One machine from its recording to a traced report: commands alone, each a process as a user starts it."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from benchmarks.strangers.command import beyond, commanded, python_in
from benchmarks.strangers.machines import MACHINES
from benchmarks.strangers.recording import Simulated
from benchmarks.strangers.rigs import free_swing, gap_damper, three_swings
from benchmarks.strangers.tanks import overflowing

SECONDS = 20.0
"""Of each recording at 500 Hz: 10,000 samples."""
SLOW = ("tank", "two_tanks", "heater", "room")


@dataclass(frozen=True)
class Machine:
    """A recording to be made, and the template that a user would take for it. ``planted``: it holds more
    than its template declares."""

    name: str
    template: str
    record: Callable[[], Simulated]
    planted: bool = False


RIGS = (
    Machine("gap_damper", "test_rig", gap_damper, planted=True),
    Machine("free_swing", "pendulum", free_swing, planted=True),
    Machine("three_swings", "pendulum", three_swings, planted=True),
    Machine("overflowing", "two_tanks", overflowing, planted=True),
)
"""Machines that lack what their template declares."""


@dataclass(frozen=True)
class Value:
    """A parameter of the traced model, its standard error, and the planted value."""

    found: float
    std: float | None
    planted: float
    unit: str

    @property
    def off(self) -> float:
        """Relative error; absolute where nothing was planted."""
        return abs(self.found - self.planted) / abs(self.planted or 1.0)


@dataclass(frozen=True)
class Outcome:
    """What came of a machine. ``wall`` and ``cpu`` are the times of each command in s. ``python`` is the
    number of lines beyond what ``new`` wrote. ``values`` are planted parameters that the traced model has,
    ``lacking`` those that it has not. ``report`` says whether the trace wrote its page."""

    machine: Machine
    wall: tuple[float, ...]
    cpu: tuple[float, ...]
    python: int
    sentence: str
    values: Mapping[str, Value]
    lacking: tuple[str, ...]
    report: bool

    @property
    def worst(self) -> str:
        """The planted parameter that is farthest off; empty if none was found."""
        return max(self.values, key=lambda name: self.values[name].off, default="")


def machines() -> tuple[Machine, ...]:
    """Each template's machine, where nothing is missing; a slide that lacks an effect; and ``RIGS``."""
    known = {"slide": "carriage"}
    made = (
        Machine(name, known.get(name, name), partial(_recorded, name), name in known) for name in MACHINES
    )
    return (*made, *RIGS)


def _recorded(name: str) -> Simulated:
    """As many samples as ``SECONDS`` have at 500 Hz: of ``SLOW`` machines at 1 Hz; the room's are minutes."""
    return MACHINES[name](500 * SECONDS if name in SLOW else SECONDS)


def played(machine: Machine, folder: Path, more: tuple[str, ...] = ()) -> Outcome:
    """Write the recording of ``machine`` to ``folder``, and run the commands of the page there; ``more`` are
    words for the trace alone.

    Raises:
        RuntimeError: if a command fails, with what it said.
    """
    made = machine.record()
    name = f"my_{machine.name}"
    files = [f"{machine.name}{k or ''}.csv" for k in range(1 + len(made.more))]
    for file, text in zip(files, (made.text, *made.more), strict=True):
        (folder / file).write_text(text, encoding="utf-8")
    case = ("--config-dir", name, f"case={name}", *made.settings)
    first, *others = (
        ("new", name, "--from", *files, "--template", machine.template, *made.words, "--simulated"),
        ("run", *case),
        ("trace", *case, *more),
    )
    took = [commanded(first, folder)]
    written = python_in(folder / name)
    took += [commanded(line, folder) for line in others]
    (trace,) = folder.glob(f"outputs/{name}/latest/trace/trace.json")
    found = json.loads(trace.read_text())
    after = found["estimates"]["after"]
    return Outcome(
        machine,
        tuple(one.wall for one in took),
        tuple(one.cpu for one in took),
        beyond(written, python_in(folder / name)),
        found["sentence"],
        {p: _value(after[p], t) for p, t in made.truth.items() if p in after},
        tuple(p for p in made.truth if p not in after),
        trace.with_name("report.html").exists(),
    )


def _value(estimate: Mapping[str, float | str | None], planted: float) -> Value:
    """One estimate of ``trace.json`` beside what was planted."""
    std = estimate["std"]
    return Value(
        float(estimate["value"] or 0.0),
        None if std is None else float(std),
        planted,
        str(estimate.get("unit", "")),
    )
