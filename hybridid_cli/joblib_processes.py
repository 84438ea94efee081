"""The processes that ``launcher=joblib`` starts for the jobs of a command; they end when the command does."""

from __future__ import annotations

import functools
import os
import signal
import sys

from pipelines.shared.parent_process import adopted, end_with
from pipelines.shared.pool_server import OF_THE_TERMINAL


def let_joblib_watch() -> None:
    """Let each process that joblib starts from here watch this one: it would work on, or wait for minutes."""
    from joblib import register_parallel_backend
    from joblib.parallel import BACKENDS

    own = functools.partial(BACKENDS["loky"], initializer=end_with_command, initargs=(os.getpid(),))
    register_parallel_backend("loky", own)
    _start_tracker()


def _start_tracker() -> None:
    """Start the process that keeps joblib's shared memory, deaf to SIGHUP as it is to Ctrl-C.

    When a terminal is closed, that signal goes to all processes of a command. This one must outlive the
    others, to clean up after them; a second one that took its place would report what it does not know.
    """
    from joblib.externals.loky.backend import resource_tracker

    if sys.platform == "win32":
        return
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGHUP})
    try:
        resource_tracker.ensure_running()
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def end_with_command(command: int) -> None:
    """End this process when the process ``command`` is gone, and leave the signals of the terminal to that
    one: here they may strike a library's callback, where Python can only print them."""
    for number in OF_THE_TERMINAL:
        signal.signal(number, signal.SIG_IGN)
    end_with(functools.partial(adopted, command))
