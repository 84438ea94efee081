"""Kills at random moments of every command: no orphan, nothing half-written, the same numbers afterwards."""

from __future__ import annotations

import os
import signal
import sys
import time
import zlib
from collections.abc import Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from benchmarks.torture import whole
from benchmarks.torture.bench import HALF, HANGS, LOST, ORPHAN, TRACEBACK, UNCLEAR, WRONG, Fault, Found, Part
from benchmarks.torture.command import Running, load
from benchmarks.torture.commands import COMMANDS, Command
from benchmarks.torture.reference import LONGEST, Reference, ended, reference, started

SIGNALS = (signal.SIGKILL, signal.SIGTERM, signal.SIGINT, signal.SIGHUP)
TRIES = 4
"""How often a command that ended before it was struck is begun again: the machine may be less busy by now."""
GRACE = 20.0
"""Seconds that workers have to end after their command: twice what they take to clean up."""


@dataclass(frozen=True)
class Kill:
    """One signal to one command, at a moment that ``seed`` draws."""

    command: Command
    number: int
    seed: int

    @property
    def key(self) -> str:
        return f"kills: {self.command.name}, {self.signal.name}, seed {self.seed}.{self.number}"

    @property
    def category(self) -> str:
        return self.command.name

    @property
    def signal(self) -> signal.Signals:
        return SIGNALS[self.number % len(SIGNALS)]

    def carried_out(self, bench: Path) -> Found:
        """Strike the command, look at what it left, and give the same command again."""
        if sys.platform != "linux":
            return Found("", skipped="finds processes in /proc")
        load()
        with self.command.around():
            return _struck(self, reference(self.command, bench))

    def drawn(self) -> tuple[float, bool, bool]:
        """The moment as a share of the command's duration; a cold cache of compiled models; Python anew."""
        generator = np.random.default_rng([self.seed, zlib.crc32(self.command.name.encode()), self.number])
        moment, cold, fresh = generator.uniform(size=3)
        return float(moment), bool(cold < 0.5), bool(fresh < 0.2) and not self.command.alone


def trials(seed: int) -> list[Kill]:
    """All kills, the commands in turn."""
    most = max(command.kills for command in COMMANDS)
    turns = ((number, command) for number in range(most) for command in COMMANDS)
    return [Kill(command, number, seed) for number, command in turns if number < command.kills]


PART = Part(
    "kills",
    "Each command is struck by a signal at a random moment. Then the same command runs again, undisturbed. "
    "Nothing that was finished may be gone, no process may stay, no file may be half-written, and no MLflow "
    "run may be left RUNNING. The second run must come to the numbers of a command that nothing disturbed.",
    (LOST, WRONG, HALF, TRACEBACK, UNCLEAR, ORPHAN, HANGS),
    trials,
    {"kills": 300},
)


def _struck(kill: Kill, done: Reference) -> Found:
    moment, cold, fresh = kill.drawn()
    seconds = done.seconds
    for _ in range(TRIES):
        done.restored(cold)
        before = whole.contents(done.lab / "outputs")
        running = started(done.words, done.lab, fresh)
        running.ready(LONGEST)
        began = time.monotonic()
        late = running.waited(moment * seconds)
        if not late:
            break
        seconds = time.monotonic() - began
    running.strike(kill.signal)
    faults = list(_after(kill, running, done, before))
    complaint = running.complaint()  # the next command says what it says to the same file
    faults += done.again()
    how = f"after {moment:.0%} of {seconds:.1f} s, {'cold' if cold else 'warm'} cache" + ", anew" * fresh
    if any(fault.kind in (TRACEBACK, UNCLEAR) for fault in faults):
        how += f"; it said: {complaint[-3000:]}"
    what = "it had ended" if late else f"exit code {running.code}"
    return Found(f"{kill.signal.name} {how}: {what}", tuple(faults), {"kills": float(not late)})


def _after(kill: Kill, running: Running, done: Reference, before: Mapping[str, str]) -> Iterator[Fault]:
    """What is wrong after the signal."""
    yield from ended(running)
    if kill.signal != signal.SIGKILL:
        yield from _unclear(kill, running)
    yield from _orphans(running)
    yield from done.lost(before)
    if kill.signal != signal.SIGKILL:
        yield from (Fault(LOST, f"MLflow: {name} is still RUNNING") for name in whole.running_runs(done.lab))


def _unclear(kill: Kill, running: Running) -> Iterator[Fault]:
    asked = 0 if kill.command.opens and kill.signal == signal.SIGINT else 128 + kill.signal
    if running.code not in (0, asked):
        yield Fault(UNCLEAR, f"exit code {running.code}, expected {asked}")
    if running.code == 128 + kill.signal and not running.last().startswith("hybridid: "):
        yield Fault(UNCLEAR, f"the last line is {running.last()!r}")


def _orphans(running: Running) -> Iterator[Fault]:
    until = time.monotonic() + GRACE
    while (left := running.left()) and time.monotonic() < until:
        time.sleep(0.1)
    for pid, said in left.items():
        yield Fault(ORPHAN, f"{pid}: {said[:200]}")
        with suppress(ProcessLookupError):
            os.kill(pid, signal.SIGKILL)
