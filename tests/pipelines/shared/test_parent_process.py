"""A process that watches its parent ends when that is killed."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[3]
FAMILY = """
import functools, os, time
from pipelines.shared.parent_process import adopted, end_with

parent = os.getpid()
if os.fork() == 0:
    end_with(functools.partial(adopted, parent))
    os.write(1, f"{os.getpid()}\\n".encode())
time.sleep(600)
"""


@pytest.mark.skipif(not hasattr(os, "fork"), reason="processes cannot be forked")
def test_a_child_ends_when_its_parent_is_killed(monkeypatch):
    monkeypatch.setenv("PYTHONPATH", str(ROOT))
    with subprocess.Popen([sys.executable, "-c", FAMILY], stdout=subprocess.PIPE, text=True) as parent:
        assert parent.stdout is not None
        child = int(parent.stdout.readline())
        os.kill(child, 0)
        parent.kill()
        parent.wait()
        until = time.monotonic() + 30
        while _lives(child):
            assert time.monotonic() < until, "the child is still there"
            time.sleep(0.1)


def _lives(pid: int) -> bool:
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return False
    stat = Path(f"/proc/{pid}/stat")
    return not stat.exists() or stat.read_text().rpartition(")")[2].split()[0] != "Z"
