"""A process that ends when its parent is gone, however that ended: who is killed cannot tell anybody."""

from __future__ import annotations

import os
import signal
import threading
import time
from collections.abc import Callable

PATIENCE = 10.0
"""Seconds that a worker has to clean up after it is told to stop."""
BETWEEN = 0.5
"""Seconds between two looks at who the parent is."""


def end_with(parent: Callable[[], object]) -> None:
    """End this process when ``parent()``, which waits for the end of its parent, returns."""
    threading.Thread(target=_end_after, args=(parent,), daemon=True).start()


def adopted(parent: int) -> None:
    """Wait until this process has another parent than the process ``parent``: the system gives it one."""
    while os.getppid() == parent:
        time.sleep(BETWEEN)


def _end_after(parent: Callable[[], object]) -> None:
    parent()
    os.kill(os.getpid(), signal.SIGTERM)
    time.sleep(PATIENCE)
    os._exit(1)
