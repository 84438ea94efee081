"""Delays the signals that ask a command to end while it writes something that must be complete."""

from __future__ import annotations

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType

HELD = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGALRM)
"""The signals that ``hybridid_cli.interrupt`` and the pool's workers turn into an exception."""


@contextmanager
def held_back() -> Iterator[None]:
    """Delay a signal that comes inside the context until its end. For work of about a second.

    Python handles signals in the main thread only. In another thread this does nothing.
    """
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    came: list[int] = []
    before = {}

    def remember(number: int, frame: FrameType | None) -> None:
        came.append(number)

    try:  # a signal may come while only some are held
        for number in HELD:
            if callable(signal.getsignal(number)):
                before[number] = signal.signal(number, remember)
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
        if came:
            signal.raise_signal(came[0])
