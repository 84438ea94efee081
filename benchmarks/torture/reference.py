"""What a command does when nothing disturbs it: the results that every disturbed one must come to."""

from __future__ import annotations

import shutil
import signal
import socket
import time
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from benchmarks.torture import whole
from benchmarks.torture.bench import HALF, HANGS, LOST, TRACEBACK, WRONG, Fault
from benchmarks.torture.command import Running, start
from benchmarks.torture.commands import Command, Words

WAITING = "mlflow-waiting"
"""The folder of the runs that were not sent to MLflow yet."""
LONGEST = 900.0
"""Seconds after which a command counts as hanging, on a busy machine."""
OWN_FOLDERS = {"XDG_CACHE_HOME": ".cache", "TMPDIR": ".tmp"}
"""The folders of a lab for compiled models and for temporary files, by the variables that name them."""
MAY_CHANGE = (".db", "config.yaml", "plan.json", "journal.log")
"""Files that a command brings up to date before it has done its work."""


class Disturbed(RuntimeError):
    """A command that nothing disturbs ended as it should not."""


@dataclass(frozen=True)
class Reference:
    """``before`` is a copy of the folder before the command. ``lab`` is where each trial happens: always the
    same path, so that files that name it are the same. ``made`` are the files of the folder that the command
    makes."""

    command: Command
    words: Words
    lab: Path
    before: Path
    seconds: float
    numbers: Mapping[str, str]
    made: Mapping[str, str]

    def restored(self, cold: bool = False) -> None:
        """Make the folder as it was before the command; ``cold``: without compiled models."""
        for path in self.lab.iterdir():
            shutil.rmtree(path) if path.is_dir() and not path.is_symlink() else path.unlink()
        shutil.copytree(self.before, self.lab, symlinks=True, dirs_exist_ok=True)
        if cold:
            shutil.rmtree(self.lab / ".cache", ignore_errors=True)
        _with_own_folders(self.lab)

    def lost(self, before: Mapping[str, str]) -> Iterator[Fault]:
        """Files of ``before`` (as ``whole.contents`` gave them) that are gone or changed, or not whole.

        A run that waits goes when it is sent; that it came is seen in MLflow, by ``differences``.
        """
        yield from (Fault(HALF, text) for text in whole.half_written(self.lab / "outputs"))
        now = whole.contents(self.lab / "outputs")
        for name, digest in before.items():
            if now.get(name) != digest and not name.endswith(MAY_CHANGE) and not name.startswith(WAITING):
                yield Fault(LOST, f"{name} was there before the command")

    def again(self) -> Iterator[Fault]:
        """What is wrong after the same command again, undisturbed, and ``log`` where runs wait to be sent."""
        if self.command.makes:
            yield from self._whole_or_absent()
        try:
            in_peace(self.words, self.lab, self.command.opens)
            if any((self.lab / "outputs" / WAITING).glob("[0-9]*")):
                in_peace(("log",), self.lab)
        except Disturbed as wrong:
            yield Fault(LOST, f"the same command again: {wrong}")
            return
        yield from self.differences()
        if self.command.makes and whole.contents(self.lab / self.command.makes) != self.made:
            yield Fault(WRONG, f"{self.command.makes} differs from that of the undisturbed command")
        yield from (Fault(HALF, f"left behind: {name}") for name in whole.left_behind(self.lab))
        yield from (Fault(LOST, f"MLflow: {name} is still RUNNING") for name in whole.running_runs(self.lab))

    def _whole_or_absent(self) -> Iterator[Fault]:
        """The folder that the command makes holds all its files, or is not there. Then it is removed."""
        folder = self.lab / self.command.makes
        if folder.exists() and whole.contents(folder) != self.made:
            yield Fault(HALF, f"{self.command.makes} is not whole")
        shutil.rmtree(folder, ignore_errors=True)

    def differences(self) -> Iterator[Fault]:
        """Results that differ from those of the undisturbed command."""
        found, expected = whole.numbers(self.lab), self.numbers
        if self.command.draws:  # as many files and runs, whatever they hold
            found, expected = whole.how_many(found), whole.how_many(expected)
        for name in sorted({*found, *expected}):
            if found.get(name) != expected.get(name):
                kind = LOST if name not in found else WRONG
                yield Fault(kind, f"{name} differs from that of the undisturbed command")


@cache
def reference(command: Command, bench: Path) -> Reference:
    """Run what comes before the command, keep that folder, then run the command.

    Raises:
        Disturbed: if that fails.
    """
    lab, before = bench / "lab", bench / "before" / "-".join(command.name.replace(",", "").split())
    words = prepared(command, lab)
    shutil.rmtree(before, ignore_errors=True)
    shutil.copytree(lab, before, symlinks=True)
    seconds = in_peace(words, lab, command.opens)
    made = whole.contents(lab / command.makes) if command.makes else {}
    return Reference(command, words, lab, before, seconds, whole.numbers(lab), made)


def prepared(command: Command, lab: Path) -> Words:
    """Make ``lab`` anew and run what comes before the command; its words in that folder.

    Raises:
        Disturbed: if that fails.
    """
    shutil.rmtree(lab, ignore_errors=True)
    lab.mkdir(parents=True)
    for line in command.before:
        in_peace(line, lab)
    return tuple(w.replace("{lab}", str(lab)).replace("{port}", str(_port())) for w in command.words)


def in_peace(words: Words, lab: Path, opens: str = "") -> float:
    """Run a command; its seconds after it heeds signals, or until it says ``opens``.

    Raises:
        Disturbed: if it does not end as it should.
    """
    running = started(words, lab)
    running.ready(LONGEST)
    began = time.monotonic()
    if opens:
        while opens not in running.complaint() and not running.waited(0.05):
            pass
        seconds = time.monotonic() - began
        running.strike(signal.SIGINT)
    if not running.waited(LONGEST) or running.code:
        raise Disturbed(f"exit code {running.code}: {running.complaint()[-2000:]}")
    return seconds if opens else time.monotonic() - began


def ended(running: Running) -> Iterator[Fault]:
    """Wait for the end of a command, and kill it if that does not come; what is wrong with it."""
    if not running.waited(LONGEST):
        yield Fault(HANGS, f"still runs after {LONGEST:g} s")
        running.strike(signal.SIGKILL)
        running.waited(LONGEST)
    if "Traceback (most recent call last)" in running.complaint():
        yield Fault(TRACEBACK, running.last())


def started(
    words: Words,
    lab: Path,
    fresh: bool = False,
    says: str = "said",
    more: Mapping[str, str] | None = None,
) -> Running:
    """The command in ``lab``, with a cache and a folder for temporary files of its own, and ``more`` in its
    environment. What it says goes to files called ``says``, outside."""
    _with_own_folders(lab)
    own = {name: str(lab / folder) for name, folder in OWN_FOLDERS.items()} | dict(more or {})
    return start(words, lab, fresh, own, lab.parent / says)


def _with_own_folders(lab: Path) -> None:
    for folder in OWN_FOLDERS.values():
        (lab / folder).mkdir(mode=0o700, exist_ok=True)


def _port() -> int:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])
