"""The processes that ``launcher=joblib`` starts for the jobs of a command; they end when the command does."""

from __future__ import annotations

import functools
import multiprocessing
import os

from pipelines.shared.parent import adopted, end_with

_COMMAND = "HYBRIDID_COMMAND"
"""The variable by which such a process knows whose it is."""
_NAMED = "Loky"
"""joblib's processes have names that begin so; a process on a node of a cluster has another parent."""


def begin() -> None:
    """This process is the command."""
    os.environ[_COMMAND] = str(os.getpid())


@functools.cache
def end_with_command() -> None:
    """End this process when the command is gone, if joblib started it. joblib itself lets it work on."""
    if multiprocessing.current_process().name.startswith(_NAMED):
        end_with(functools.partial(adopted, int(os.environ[_COMMAND])))
