"""Tasks in processes of their own: results, words, failures, kills."""

from __future__ import annotations

import contextlib
import os
import signal
import subprocess
import sys
import threading
import time
import warnings
from dataclasses import dataclass
from pathlib import Path

import pytest

import hybridid
from pipelines.shared.parent_process import PATIENCE
from pipelines.shared.pool import Lost, mapper_of, side_by_side


def work(given, watcher):
    """What the tests' processes do: ``given`` names it."""
    watcher.say(f"{given} in {os.getpid()}")
    if given == "killed":
        os.kill(os.getpid(), signal.SIGKILL)
    if given == "exits":
        os._exit(3)
    if given == "warns":
        warnings.warn_explicit("models are interpreted", UserWarning, hybridid.__file__, 1)
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


def test_a_warning_of_hybridid_is_told_as_a_warning(capfd):
    """Python would write it with its place in the code, and without the name of the task."""
    _, heard = run("warns")
    assert ("warns", "models are interpreted") in heard
    assert "UserWarning" not in capfd.readouterr().err


def test_a_process_that_dies_takes_only_its_own_task_along():
    found, _ = run("killed", "a", "exits", "b")
    assert found["killed"] == Lost("its process was killed by SIGKILL")
    assert found["exits"] == Lost("its process ended with code 3")
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
from pipelines.shared.pool import mapper_of, side_by_side

class Deaf:
    def say(self, line): pass

def work(given, watcher=None):
    os.write(1, f"{os.getpid()}\\n".encode())
    while True:
        time.sleep(0.1)

if __name__ == "__main__":
    if sys.argv[1] == "tasks":
        dict(side_by_side(work, {"a": 0, "b": 0}, 2, lambda name: Deaf()))
    with mapper_of(2) as mapper:
        list(mapper(work, [(0,), (0,)]))
"""


@pytest.mark.skipif(not Path("/proc/self/stat").exists(), reason="finds processes in /proc")
@pytest.mark.parametrize("way", ["tasks", "mapper"])
@pytest.mark.parametrize("number", [signal.SIGKILL, signal.SIGTERM])
def test_no_process_outlives_its_parent(tmp_path, way, number):
    """A parent that is killed cannot tell anybody: its workers, their server and its tracker see it."""
    (tmp_path / "parent.py").write_text(PARENT)
    command = [sys.executable, "parent.py", way]
    parent = subprocess.Popen(command, cwd=tmp_path, stdout=subprocess.PIPE, text=True, process_group=0)
    workers = {int(parent.stdout.readline()) for _ in range(2)}
    assert workers < group(parent.pid)
    parent.send_signal(number)
    parent.wait()
    until = time.monotonic() + PATIENCE
    while left := group(parent.pid):
        assert time.monotonic() < until, f"{left} are still there"
        time.sleep(0.1)
    parent.stdout.close()


def group(leader):
    """The living processes of a group."""
    found = set()
    for stat in Path("/proc").glob("[0-9]*/stat"):
        with contextlib.suppress(OSError):
            _, _, rest = stat.read_text().rpartition(")")
            state, _, its_group = rest.split()[:3]
            if int(its_group) == leader and state != "Z":
                found.add(int(stat.parent.name))
    return found


def squared(x, wait=0.0):
    """What the mapper's processes do: ``x`` names it."""
    time.sleep(wait)
    if x == "killed":
        os.kill(os.getpid(), signal.SIGKILL)
    if x == "cut off":
        threading.Timer(0.02, os.kill, (os.getpid(), signal.SIGKILL)).start()
        return b"x" * 500_000_000
    return x * x, os.getpid()


def test_a_mapper_keeps_the_order_and_its_processes():
    with mapper_of(2) as mapper:
        first = list(mapper(squared, ((x, 0.3 * (x == 0)) for x in range(5))))
        again = list(mapper(squared, ((x,) for x in range(5))))
        assert [square for square, _ in first] == [square for square, _ in again] == [0, 1, 4, 9, 16]
        pids = {pid for _, pid in first}
        assert {pid for _, pid in again} == pids
        assert len(pids) == 2
    for pid in pids:
        with pytest.raises(ProcessLookupError):
            os.kill(pid, 0)


def grown(shared, x):
    shared.append(x)
    return len(shared), os.getpid()


def test_what_all_calls_share_reaches_a_process_once():
    with mapper_of(2) as mapper:
        found = list(mapper(grown, [([], 1) for _ in range(4)]))
        assert {length for length, _ in found} == {1}
        shared = []
        found = list(mapper(grown, [(shared, x) for x in range(6)]))
    for pid in {pid for _, pid in found}:
        lengths = [length for length, own in found if own == pid]
        assert lengths == list(range(1, len(lengths) + 1))
    assert shared == []


def test_what_a_call_raises_comes_in_its_turn_with_its_traceback():
    with mapper_of(2) as mapper:
        results = mapper(squared, [(2, 0.3), ("no number",), (4,)])
        assert next(results)[0] == 4
        with pytest.raises(TypeError, match="can't multiply") as raised:
            next(results)
        assert "return x * x" in raised.value.__notes__[0]
        assert next(iter(mapper(squared, [(5,)])))[0] == 25


@pytest.mark.parametrize("how", ["killed", "cut off"])
def test_a_mapper_outlives_a_killed_process(how):
    """Also one killed in the midst of sending its result."""
    with mapper_of(2) as mapper:
        with pytest.raises(ChildProcessError, match="squared: its process was killed by SIGKILL"):
            list(mapper(squared, [(1,), (how,), (3,)]))
        assert [square for square, _ in mapper(squared, [(1,), (2,), (3,)])] == [1, 4, 9]


def test_an_idle_process_that_is_killed_costs_nothing():
    with mapper_of(2) as mapper:
        (_, pid), _ = mapper(squared, [(1, 0.2), (2, 0.2)])
        with contextlib.suppress(ProcessLookupError):
            while True:
                os.kill(pid, signal.SIGKILL)
        assert [square for square, _ in mapper(squared, [(1,), (2,), (3,)])] == [1, 4, 9]


def test_a_call_within_a_call_has_processes_of_its_own():
    with mapper_of(2) as mapper:
        outer = mapper(squared, [(1,), (2, 0.5), (3,)])
        assert next(outer)[0] == 1
        assert [square for square, _ in mapper(squared, [(4,), (5,)])] == [16, 25]
        assert [square for square, _ in outer] == [4, 9]


def test_a_process_that_is_killed_as_it_starts_is_named(monkeypatch):
    from pipelines.shared import pool as module

    started, lost = module._started, []

    def killed_once():
        if not lost:
            lost.append(True)
            raise EOFError("unexpected EOF")
        return started()

    monkeypatch.setattr(module, "_started", killed_once)
    found, _ = run("a", "b", processes=1)
    assert found["a"] == Lost("its process was killed as it started")
    assert found["b"].startswith("b done")
