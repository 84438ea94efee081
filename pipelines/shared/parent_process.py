"""A process that ends when its parent has ended. It watches the parent: a killed one sends no message."""

from __future__ import annotations

import os
import signal
import threading
import time
from collections.abc import Callable

PATIENCE = 10.0
"""Seconds that a worker has to clean up after it is told to stop."""
BETWEEN = 0.5
"""Seconds between two checks of who the parent is."""


def end_with(parent: Callable[[], object]) -> None:
    """End this process when ``parent()`` returns. The call of ``parent`` waits for the end of the parent."""
    threading.Thread(target=_end_after, args=(parent,), daemon=True).start()


def adopted(parent: int) -> None:
    """Wait until the process ``parent`` has ended. The system then gives this process another parent."""
    while os.getppid() == parent:
        time.sleep(BETWEEN)


def _end_after(parent: Callable[[], object]) -> None:
    parent()
    os.kill(os.getpid(), signal.SIGTERM)
    time.sleep(PATIENCE)
    os._exit(1)
