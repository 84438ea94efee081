"""The processes that ``launcher=joblib`` starts for the jobs of a command; they end when the command does."""

from __future__ import annotations

import functools
import os

from pipelines.shared.parent_process import adopted, end_with


def let_joblib_watch() -> None:
    """Let each process that joblib starts from here watch this one: it would work on, or wait for minutes."""
    from joblib import register_parallel_backend
    from joblib.parallel import BACKENDS

    own = functools.partial(BACKENDS["loky"], initializer=end_with_command, initargs=(os.getpid(),))
    register_parallel_backend("loky", own)


def end_with_command(command: int) -> None:
    """End this process when the process ``command`` is gone."""
    end_with(functools.partial(adopted, command))
