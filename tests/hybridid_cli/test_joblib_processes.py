"""The processes that joblib starts for a command end with it, also those that never got a job."""

from __future__ import annotations

import importlib
import os
import signal
import subprocess
import sys
import time
from contextlib import suppress
from pathlib import Path

import pytest

COMMAND = """
import time
from joblib import Parallel, delayed
from hybridid_cli.joblib_processes import let_joblib_watch

let_joblib_watch()
Parallel(n_jobs=3, backend="loky")([delayed(time.sleep)(120)])
"""
MARK = "HYBRIDID_TEST_OF_JOBLIB"


def marked(mark: str) -> dict[int, str]:
    """The living processes whose environment holds ``mark``, by their command lines."""
    found = {}
    for place in Path("/proc").glob("[0-9]*"):
        with suppress(OSError):
            alive = (place / "stat").read_text().rpartition(")")[2].split()[0] not in "ZX"
            if alive and f"{MARK}={mark}".encode() in (place / "environ").read_bytes().split(b"\0"):
                found[int(place.name)] = (place / "cmdline").read_bytes().replace(b"\0", b" ").decode()
    return found


@pytest.mark.skipif(sys.platform != "linux", reason="finds processes in /proc")
def test_joblib_s_processes_end_when_the_command_is_killed(environment, tmp_path):
    mark = str(tmp_path)
    command = subprocess.Popen(
        [sys.executable, "-c", COMMAND], env={**environment, MARK: mark}, stderr=subprocess.DEVNULL
    )
    try:
        until = time.monotonic() + 60
        while sum("--process-name Loky" in said for said in marked(mark).values()) < 3:
            assert time.monotonic() < until, marked(mark)
            time.sleep(0.05)
        command.kill()
        command.wait()
        until = time.monotonic() + 20
        while left := marked(mark):
            assert time.monotonic() < until, left
            time.sleep(0.05)
    finally:
        for pid in marked(mark):
            with suppress(ProcessLookupError):
                os.kill(pid, signal.SIGKILL)


TRACKER = """
import os, signal, time
from joblib.externals.loky.backend import resource_tracker
from hybridid_cli.joblib_processes import let_joblib_watch

let_joblib_watch()
tracker = resource_tracker._resource_tracker
first = tracker._pid
os.kill(first, signal.SIGHUP)
time.sleep(0.5)
tracker.register("/dev/shm/none", "file")
tracker.unregister("/dev/shm/none", "file")
assert tracker._pid == first
signal.raise_signal(signal.SIGHUP)
"""


@pytest.mark.skipif(sys.platform != "linux", reason="signals of a terminal")
def test_a_closed_terminal_leaves_the_process_that_cleans_up(environment):
    """A second tracker took its place, and printed a traceback for each resource that it did not know."""
    done = subprocess.run([sys.executable, "-c", TRACKER], env=environment, capture_output=True, text=True)
    assert (done.returncode, done.stderr) == (-signal.SIGHUP, "")


WORKERS = """
import os, signal, time
from joblib import Parallel, delayed
from hybridid_cli.joblib_processes import let_joblib_watch

def struck(number):
    os.kill(os.getpid(), number)
    time.sleep(0.2)
    return "goes on"

let_joblib_watch()
print(Parallel(n_jobs=2, backend="loky")([delayed(struck)(n) for n in (signal.SIGINT, signal.SIGHUP)]))
"""


@pytest.mark.skipif(sys.platform != "linux", reason="signals of a terminal")
def test_joblib_s_processes_leave_the_signals_of_the_terminal_to_the_command(environment):
    """Ctrl-C struck a library's callback there, which Python can only print."""
    done = subprocess.run([sys.executable, "-c", WORKERS], env=environment, capture_output=True, text=True)
    assert done.stdout == "['goes on', 'goes on']\n"


@pytest.mark.parametrize("several", ["-m", "hydra.mode=MULTIRUN"])
@pytest.mark.parametrize(("launcher", "watched"), [("joblib", 1), ("local", 0)])
def test_joblib_watches_however_several_runs_are_asked_for(
    say, quick, monkeypatch, several, launcher, watched
):
    calls = []

    def no_processes(*given, **more):
        raise RuntimeError("no processes in a test")

    monkeypatch.setattr("hybridid_cli.multirun.let_joblib_watch", lambda: calls.append(1))
    core = importlib.import_module("hydra_plugins.hydra_joblib_launcher._core")
    monkeypatch.setattr(core, "Parallel", no_processes)
    said = say("fit", *quick, several, f"launcher={launcher}", "effects=[nonsense]")
    assert said.code != 0
    assert len(calls) == watched
