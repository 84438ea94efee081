"""A command of hybridid in a session of its own: started, struck by a signal, and looked for afterwards.

Its process is forked from this one, which has imported all that the commands need: a start takes no seconds,
and a trial strikes the work and not the imports. ``fresh`` starts Python anew.
"""

from __future__ import annotations

import atexit
import importlib
import os
import signal
import sys
import tempfile
import threading
import time
import traceback
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import NoReturn

from benchmarks.torture.bench import ROOT

MARK = "HYBRIDID_TORTURE"
"""The variable by which processes are found that left the session: children inherit it."""
NEEDED = (
    "hydra.main", "hybridid_cli.tasks", "hybridid_cli.sweeper", "hybridid_cli.explain",
    "hybridid_cli.results", "pipelines.runner", "pipelines.sweep.work", "pipelines.tune.worker",
    "pipelines.reproduce", "pandas",
    "pipelines.tracking.runs", "pipelines.fetching", "hybridid.plotting.style", "pyarrow.parquet",
    "mlflow.tracking", "mlflow.store.tracking.sqlalchemy_store", "hybridid.residuals.training", "optuna",
)  # fmt: skip
POLL = 0.01


@dataclass
class Running:
    """A command that was started. ``code`` is negative for a signal, None while it runs."""

    pid: int
    mark: str
    out: Path
    err: Path
    code: int | None = None

    def waited(self, seconds: float) -> bool:
        """Wait for its end at most ``seconds``; whether it has ended."""
        until = time.monotonic() + seconds
        while self.code is None:
            pid, status = os.waitpid(self.pid, os.WNOHANG)
            if pid:
                self.code = os.waitstatus_to_exitcode(status)
            elif time.monotonic() > until:
                return False
            else:
                time.sleep(POLL)
        return True

    def ready(self, seconds: float) -> bool:
        """Wait until it heeds signals; False if it ended before or does not within ``seconds``."""
        until = time.monotonic() + seconds
        while not self.waited(0) and time.monotonic() < until:
            if _heeds(self.pid):
                return True
            time.sleep(POLL)
        return False

    def strike(self, number: signal.Signals) -> None:
        """Send a signal: that of a terminal goes to all processes of the session, others to the command."""
        with suppress(ProcessLookupError):
            if number in (signal.SIGINT, signal.SIGHUP):
                os.killpg(self.pid, number)
            else:
                os.kill(self.pid, number)

    def left(self) -> dict[int, str]:
        """The living processes of its session, or that bear its mark, by their command lines; not itself."""
        found = {}
        for place in Path("/proc").glob("[0-9]*"):
            with suppress(OSError):
                _, _, rest = (place / "stat").read_text().rpartition(")")
                state, _, _, session = rest.split()[:4]
                marked = f"{MARK}={self.mark}".encode() in _environment(place).split(b"\0")
                if state not in "ZX" and (int(session) == self.pid or marked):
                    found[int(place.name)] = (place / "cmdline").read_bytes().replace(b"\0", b" ").decode()
        return {pid: said for pid, said in found.items() if pid not in (self.pid, os.getpid())}

    def complaint(self) -> str:
        """All that it said on stderr."""
        return self.err.read_text(encoding="utf-8", errors="replace")

    def last(self) -> str:
        """The last line of it."""
        return "".join(self.complaint().strip().splitlines()[-1:])


def _environment(process: Path) -> bytes:
    """What stands in its ``environ``, read again for one second while it is empty: a process that executes a
    new program has none for a moment.

    Raises:
        OSError: the process has no program: a thread of the kernel, or one that has ended.
    """
    (process / "exe").readlink()
    until = time.monotonic() + 1
    while not (found := (process / "environ").read_bytes()) and time.monotonic() < until:
        time.sleep(0.01)
    return found


@cache
def load() -> None:
    """Import what the commands need, and compile the rig's equations: once, before any process is forked."""
    for name in NEEDED:
        importlib.import_module(name)
    importlib.import_module("hybridid.rigs.emps").EMPSRig().record("identification", duration=0.1)


def start(
    words: Sequence[str],
    folder: Path,
    fresh: bool = False,
    environment: Mapping[str, str] | None = None,
    says: Path | None = None,
) -> Running:
    """Start ``hybridid`` with ``words`` in ``folder``; what it says goes to ``says``.out and .err."""
    said = says or Path(tempfile.mkdtemp(prefix="torture-")) / "said"
    mark = f"{os.getpid()}-{time.monotonic_ns()}"
    out, err = said.with_suffix(".out"), said.with_suffix(".err")
    for path in (out, err):
        path.write_bytes(b"")
    sys.stdout.flush()
    sys.stderr.flush()
    pid = os.fork()
    if pid == 0:
        _become(words, folder, fresh, {**(environment or {}), MARK: mark}, out, err)
    return Running(pid, mark, out, err)


def _become(
    words: Sequence[str], folder: Path, fresh: bool, environment: Mapping[str, str], out: Path, err: Path
) -> NoReturn:
    """Become the command; it never returns."""
    code = 99
    try:
        os.setsid()
        os.chdir(folder)
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
            signal.signal(number, signal.SIG_DFL)
        os.environ.pop("HYBRIDID_DATA", None)
        os.environ |= {"PYTHONPATH": str(ROOT), **environment}
        os.dup2(os.open(os.devnull, os.O_RDONLY), 0)
        for stream, path in ((1, out), (2, err)):
            os.dup2(os.open(path, os.O_WRONLY | os.O_APPEND), stream)
        if fresh:
            os.execv(sys.executable, [sys.executable, "-m", "hybridid_cli", *words])
        sys.stdout, sys.stderr = os.fdopen(1, "w"), os.fdopen(2, "w")
        sys.argv = ["hybridid", *words]
        code = _main()
    except BaseException:
        traceback.print_exc()
    finally:
        with suppress(OSError):
            sys.stdout.flush()
            sys.stderr.flush()
        os._exit(code)


def _main() -> int:
    """Run the command and end as Python does; returns the exit code."""
    from hybridid_cli.main import main

    code = 0
    try:
        main()
    except SystemExit as end:
        code = end.code if isinstance(end.code, int) else int(end.code is not None)
    threading._shutdown()  # type: ignore[attr-defined]
    atexit._run_exitfuncs()
    return code


def _heeds(pid: int) -> bool:
    """Whether a process has a handler of its own for SIGTERM."""
    try:
        status = Path(f"/proc/{pid}/status").read_text()
    except OSError:
        return False
    caught = next(int(line.split()[1], 16) for line in status.splitlines() if line.startswith("SigCgt"))
    return bool(caught >> (signal.SIGTERM - 1) & 1)
