"""The processes that ``launcher=joblib`` starts for the jobs of a command. They end when the command ends."""

from __future__ import annotations

import functools
import os
import signal
import sys

from pipelines.shared.parent_process import adopted, end_with
from pipelines.shared.pool_server import OF_THE_TERMINAL


def let_joblib_watch() -> None:
    """Make each process that joblib starts from now on end when this process ends.

    Without this it would finish its job first, or wait some minutes for another one.
    """
    from joblib import register_parallel_backend
    from joblib.parallel import BACKENDS

    own = functools.partial(BACKENDS["loky"], initializer=end_with_command, initargs=(os.getpid(),))
    register_parallel_backend("loky", own)
    _start_tracker()


def _start_tracker() -> None:
    """Start joblib's resource tracker, the process that removes its shared memory, with SIGHUP blocked.

    The tracker ignores Ctrl-C but not SIGHUP, which all processes of a command get when the terminal is
    closed. The tracker must run longer than the other processes, because it cleans up after them. If it ended
    first, joblib would start a second one. That one would print errors about resources that it does not know.
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
    """End this process when the process ``command`` has ended.

    This process ignores the signals of the terminal; ``command`` handles them. Here a signal could arrive
    inside a library's callback, where Python can only print the exception.
    """
    for number in OF_THE_TERMINAL:
        signal.signal(number, signal.SIG_IGN)
    end_with(functools.partial(adopted, command))
