"""Tasks in processes of their own: results, words, failures, kills."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from dataclasses import dataclass

import pytest

from pipelines.shared.side_by_side import PATIENCE, Died, side_by_side


def work(given, watcher):
    """What the tests' processes do: ``given`` names it."""
    watcher.say(f"{given} in {os.getpid()}")
    if given == "killed":
        os.kill(os.getpid(), signal.SIGKILL)
    if given == "exits":
        os._exit(3)
    if given == "endless":
        while True:
            time.sleep(0.05)
            watcher.carry_on()
    watcher.progress("work", given, 0.5)
    return f"{given} done with {os.environ['OMP_NUM_THREADS']} thread"


@dataclass
class Named:
    """A watcher that writes under its name."""

    name: str
    heard: list

    def say(self, line):
        self.heard.append((self.name, line))

    warn = say

    def carry_on(self):
        pass

    def progress(self, work, state, fraction):
        self.heard.append((self.name, f"{work}: {state} {fraction}"))


def run(*given, processes=2):
    heard: list = []
    found = dict(side_by_side(work, {g: g for g in given}, processes, lambda name: Named(name, heard)))
    return found, heard


def pids(heard):
    return [int(line.rpartition(" ")[2]) for _, line in heard if " in " in line]


def test_every_task_gives_its_result_in_a_process_of_one_thread():
    found, heard = run("a", "b", "c")
    assert found == {name: f"{name} done with 1 thread" for name in "abc"}
    assert len(set(pids(heard))) == 2  # the third goes to the process that is free first
    assert ("b", "begins") in heard
    assert ("c", "work: c 0.5") in heard


def test_a_process_that_dies_takes_only_its_own_task_along():
    found, _ = run("killed", "a", "exits", "b")
    assert found["killed"] == Died("its process was killed by SIGKILL")
    assert found["exits"] == Died("its process ended with code 3")
    assert found["a"].startswith("a done")
    assert found["b"].startswith("b done")


def test_whoever_leaves_takes_the_processes_along():
    heard: list = []

    class Leaves(Named):
        def say(self, line):
            super().say(line)
            if " in " in line:
                raise KeyboardInterrupt

    began = time.monotonic()
    with pytest.raises(KeyboardInterrupt):
        dict(side_by_side(work, {"endless": "endless"}, 2, lambda name: Leaves(name, heard)))
    assert time.monotonic() - began < PATIENCE  # it was told to stop, and did
    with pytest.raises(ProcessLookupError):
        os.kill(pids(heard)[0], 0)


PARENT = """
import os, sys, time
from pipelines.shared.side_by_side import side_by_side

class Deaf:
    def say(self, line): pass

def work(given, watcher):
    sys.stdout.write(f"{os.getpid()}\\n")
    sys.stdout.flush()
    while True:
        time.sleep(0.1)

if __name__ == "__main__":
    dict(side_by_side(work, {"endless": 0}, 1, lambda name: Deaf()))
"""


def test_a_process_does_not_outlive_its_parent(tmp_path):
    """A parent that is killed cannot tell anybody."""
    (tmp_path / "parent.py").write_text(PARENT)
    parent = subprocess.Popen([sys.executable, "parent.py"], cwd=tmp_path, stdout=subprocess.PIPE, text=True)
    child = int(parent.stdout.readline())
    parent.kill()
    parent.communicate()
    for _ in range(100):
        try:
            os.kill(child, 0)
        except ProcessLookupError:
            return
        time.sleep(0.1)
    pytest.fail("the process is still there")


def test_a_process_that_is_killed_as_it_starts_is_named(monkeypatch):
    from pipelines.shared import side_by_side as module

    started, lost = module._started, []

    def killed_once(work):
        if not lost:
            lost.append(True)
            raise EOFError("unexpected EOF")
        return started(work)

    monkeypatch.setattr(module, "_started", killed_once)
    found, _ = run("a", "b", processes=1)
    assert found["a"] == Died("its process was killed as it started")
    assert found["b"].startswith("b done")
