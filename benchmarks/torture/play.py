"""Runs cases, each in a process of its own that is forked from one that has loaded everything."""

from __future__ import annotations

import importlib
import os
import resource
import shutil
import signal
import sys
import tempfile
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from multiprocessing import forkserver
from pathlib import Path

from benchmarks.torture.case import Case, Content, Said

LOADED = (
    "hydra.main", "hybridid_cli.tasks", "hybridid_cli.explain", "hybridid_cli.results", "pipelines.runner",
    "pipelines.shared.augmented", "pipelines.tracking.runs", "pipelines.fetching", "scipy.optimize",
    "pandas", "pymatreader", "pyarrow.parquet",
)  # fmt: skip
MEMORY = 6 * 2**30
"""Bytes of address space that a case may ask for: a limit that does not hold must not take the machine."""


def load() -> None:
    """Import what the commands need, once."""
    for name in LOADED:
        importlib.import_module(name)


def play(case: Case, lab: Callable[[Path], None]) -> Said:
    """The answer to ``case``, in a new folder that ``lab`` fills."""
    with new_folder() as folder:
        lab(folder)
        for name, content in case.files.items():
            write(folder / name, content)
        return answer(case.words, folder, case.seconds)


@contextmanager
def new_folder(within: Path | None = None) -> Iterator[Path]:
    """A new folder, which goes whatever its modes are by then."""
    folder = Path(tempfile.mkdtemp(prefix="torture-", dir=within))
    try:
        yield folder
    finally:
        for path in folder.rglob("*"):
            with suppress(OSError):
                if path.is_dir() and not path.is_symlink():
                    path.chmod(0o755)
        shutil.rmtree(folder, ignore_errors=True)


def write(path: Path, content: Content) -> None:
    """Write one file of a case."""
    path.parent.mkdir(parents=True, exist_ok=True)
    if isinstance(content, str):
        path.write_text(content, encoding="utf-8")
    elif isinstance(content, bytes):
        path.write_bytes(content)
    else:
        content(path)


def answer(
    words: Sequence[str],
    folder: Path,
    seconds: float,
    environment: Mapping[str, str] | None = None,
    script: Path | None = None,
    opens: str = "",
) -> Said:
    """What ``hybridid`` with ``words`` answers in ``folder``, with more in its environment. ``script`` is
    ``hybridid`` as it is installed: it starts Python anew. A command that ``opens`` something is told to end
    when it says so."""
    with tempfile.TemporaryDirectory() as own:
        out, err = Path(own) / "out", Path(own) / "err"
        began = time.monotonic()
        sys.stdout.flush(), sys.stderr.flush()
        child = os.fork()
        if child == 0:
            _child(words, folder, out, err, environment or {}, script)
        if opens:
            _ended_when_open(child, opens, err, began + seconds)
        code = _waited(child, seconds)
        took = time.monotonic() - began
        left = tuple(str(p.relative_to(folder)) for p in folder.rglob("*"))
        text = [p.read_text(encoding="utf-8", errors="replace") if p.exists() else "" for p in (out, err)]
        return Said(code, *text, took, left)


def _ended_when_open(child: int, opens: str, err: Path, last: float) -> None:
    """Press Ctrl-C when the command says ``opens``."""
    while time.monotonic() < last and not (err.exists() and opens in err.read_text(errors="replace")):
        if os.waitid(os.P_PID, child, os.WEXITED | os.WNOHANG | os.WNOWAIT):
            return
        time.sleep(0.05)
    os.kill(child, signal.SIGINT)


def _forget() -> None:
    """Hold no compiled model and no folder for them, as a process that nobody forked."""
    from hybridid.private import cache_folder
    from hybridid.simulation.compiler import forget

    cache_folder.cache_clear()
    forget()


def _waited(child: int, seconds: float) -> int:
    last = time.monotonic() + seconds
    while time.monotonic() < last:
        pid, status = os.waitpid(child, os.WNOHANG)
        if pid:
            return os.waitstatus_to_exitcode(status)
        time.sleep(0.005)
    os.killpg(child, 9)
    return os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])


def _child(
    words: Sequence[str],
    folder: Path,
    out: Path,
    err: Path,
    environment: Mapping[str, str],
    script: Path | None,
) -> None:
    """Become ``hybridid`` with ``words``; never returns."""
    code = 99
    try:
        os.setpgid(0, 0)
        # the server of the process that this one was forked from is no child of this one
        forkserver._forkserver._forkserver_pid = None
        os.chdir(folder)
        os.environ.pop("HYBRIDID_DATA", None)
        os.environ.update(environment)
        resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
        for number, path in ((1, out), (2, err)):
            os.dup2(os.open(path, os.O_WRONLY | os.O_CREAT | os.O_APPEND), number)
        if script is not None:
            os.execv(sys.executable, [sys.executable, str(script), *words])
        sys.stdout = open(1, "w", closefd=False)  # noqa: SIM115
        sys.stderr = open(2, "w", closefd=False)  # noqa: SIM115
        sys.argv = ["hybridid", *words]
        from hybridid_cli.main import main

        _forget()
        main()
    except SystemExit as end:
        code = end.code if isinstance(end.code, int) else 1
    except BaseException:
        import traceback

        traceback.print_exc()
    finally:
        with suppress(Exception):
            sys.stdout.flush(), sys.stderr.flush()
        os._exit(code)
