"""The process that workers are forked from: how it starts, and what it imports first.

Its parent may end while it still imports libraries, which takes seconds. On Linux the kernel then ends it at
once. On other systems it ends after these imports. The workers watch the parent themselves.
"""

from __future__ import annotations

import ctypes
import multiprocessing
import os
import signal
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from multiprocessing import forkserver, resource_tracker

METHOD = "forkserver" if "forkserver" in multiprocessing.get_all_start_methods() else "spawn"
OF_THE_TERMINAL = (signal.SIGINT, signal.SIGHUP)
LIBRARIES = ("OMP", "MKL", "OPENBLAS", "BLIS", "NUMBA", "NUMEXPR")
THREADS = (*(f"{name}_NUM_THREADS" for name in LIBRARIES), "VECLIB_MAXIMUM_THREADS")
_SET_PARENT_DEATH_SIGNAL = 1  # PR_SET_PDEATHSIG of <linux/prctl.h>
_SERVES = "from multiprocessing.forkserver import main"

if sys.platform == "linux" and sys.orig_argv[-1].startswith(_SERVES):
    ctypes.CDLL(None).prctl(_SET_PARENT_DEATH_SIGNAL, signal.SIGTERM)


def ensure_server(*modules: str) -> None:
    """Start the server, if there is none yet and processes can be forked. It imports ``modules``.

    The server and its children ignore the signals of the terminal, which go to all processes of a command.
    This process decides what to do then. In the server a signal could interrupt an import, and Python would
    print a traceback.
    """
    if METHOD != "forkserver":
        return
    before = signal.pthread_sigmask(signal.SIG_BLOCK, OF_THE_TERMINAL)
    try:
        forkserver.set_forkserver_preload([__name__, "__main__", *modules])
        resource_tracker.ensure_running()  # lets SIGINT through again, as it starts
        signal.pthread_sigmask(signal.SIG_BLOCK, OF_THE_TERMINAL)
        with one_thread():
            forkserver.ensure_running()
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


@contextmanager
def one_thread() -> Iterator[None]:
    """One thread for each numerical library: the processes already use every core."""
    before = {name: os.environ.get(name) for name in THREADS}
    os.environ.update(dict.fromkeys(THREADS, "1"))
    try:
        yield
    finally:
        for name, value in before.items():
            if value is None:
                del os.environ[name]
            else:
                os.environ[name] = value
