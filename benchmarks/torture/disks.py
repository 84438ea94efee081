"""Disks that fill up or cannot be written: one clear line, nothing half-written, and nothing lost later."""

from __future__ import annotations

import os
import subprocess
import sys
import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from benchmarks.torture import whole
from benchmarks.torture.bench import HALF, HANGS, LOST, TRACEBACK, UNCLEAR, WRONG, Fault, Found, Part
from benchmarks.torture.command import Running, load
from benchmarks.torture.commands import COMMANDS, Command
from benchmarks.torture.reference import Reference, ended, reference, started

EACH = 3
"""Full disks of each command, of different sizes; and one that cannot be written."""
WRITES = tuple(c for c in COMMANDS if c.name not in ("ui", "cases", "effects", "completion"))
BLOCK = 4096
AMPLE = "size=512m"
SAYS = ("space", "disk", "read-only", "write")
"""One of these words is in a line that is clear."""


@dataclass(frozen=True)
class Disk:
    """A command on a disk that fills up (``number`` from 0) or cannot be written (None)."""

    command: Command
    number: int | None
    seed: int

    @property
    def key(self) -> str:
        kind = "read-only" if self.number is None else f"full, seed {self.seed}.{self.number}"
        return f"disks: {self.command.name}, {kind}"

    @property
    def category(self) -> str:
        return "read-only" if self.number is None else "full"

    def carried_out(self, bench: Path) -> Found:
        """Run the command on such a disk, then give it room, and give the same command again."""
        if sys.platform != "linux" or os.geteuid() != 0:
            return Found("", skipped="only root may mount a small disk")
        load()
        with self.command.around():
            done = reference(self.command, bench)
            before, after = _bytes(done.before), _bytes(done.lab)
            with _mounted(done.lab):
                return _filled(self, done, before, after)

    def share(self) -> float:
        """Of what the command writes, the part that fits."""
        name = zlib.crc32(self.command.name.encode())
        return float(np.random.default_rng([self.seed, name, self.number or 0]).uniform())


def trials(seed: int) -> list[Disk]:
    """All disks, the commands in turn."""
    return [Disk(command, number, seed) for number in (None, *range(EACH)) for command in WRITES]


PART = Part(
    "disks",
    "Each command runs on a disk that cannot be written, and on disks that fill up at a random moment. "
    "Then the disk gets room, and the same command runs again.",
    (LOST, WRONG, HALF, TRACEBACK, UNCLEAR, HANGS),
    trials,
)


def _filled(disk: Disk, done: Reference, before: int, after: int) -> Found:
    done.restored()
    there = whole.contents(done.lab / "outputs")
    room = int(before + disk.share() * max(after - before, BLOCK)) // BLOCK + 1
    _remount(done.lab, "ro" if disk.number is None else f"size={room * BLOCK}")
    running = started(done.words, done.lab)
    faults = list(_said(disk, running))
    complaint, last = running.complaint(), running.last()  # the next command says it to the same file
    faults += done.lost(there)
    _remount(done.lab, f"rw,{AMPLE}")
    faults += done.again()
    said = (
        f"room for {room * BLOCK / 1e6:.2f} of {after / 1e6:.2f} MB" if disk.number is not None else "no room"
    )
    said += f": exit code {running.code}: "
    said += complaint[-3000:] if faults else last[:400]
    return Found(said, tuple(faults), {"disks": 1.0})


def _said(disk: Disk, running: Running) -> Iterator[Fault]:
    """What is wrong with the answer. A command may end well with a warning: what it could not do was not its
    work."""
    yield from ended(running)
    last = running.last()
    if running.code == 0:
        if disk.number is None and "WARNING" not in running.complaint():
            yield Fault(WRONG, "exit code 0 without a warning, though nothing can be written")
    elif not last.startswith("hybridid: ") or not any(word in last.lower() for word in SAYS):
        yield Fault(UNCLEAR, f"exit code {running.code}: {last[:300]!r}")
    elif "--debug" in last:
        yield Fault(UNCLEAR, f"a raw exception: {last[:300]!r}")


def _bytes(folder: Path) -> int:
    """What the files of a folder take on a disk, in whole blocks."""
    sizes = (path.lstat().st_size for path in folder.rglob("*"))
    return sum(-(-size // BLOCK) * BLOCK for size in sizes)


@contextmanager
def _mounted(lab: Path) -> Iterator[None]:
    """A disk of its own at ``lab``, and what lay there hidden below it."""
    subprocess.run(["mount", "-t", "tmpfs", "-o", AMPLE, "torture", str(lab)], check=True)
    try:
        yield
    finally:
        subprocess.run(["umount", "--lazy", str(lab)], check=True)


def _remount(lab: Path, how: str) -> None:
    subprocess.run(["mount", "-o", f"remount,{how}", str(lab)], check=True)
