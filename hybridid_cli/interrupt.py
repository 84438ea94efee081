"""Ctrl-C: remembered when it comes, for libraries may swallow the exception or disguise it.

CasADi, struck while it converts arguments, reports a wrong type instead.
"""

from __future__ import annotations

import signal
from types import FrameType
from typing import NoReturn

_seen = False


class Interrupted(KeyboardInterrupt):
    """Ctrl-C. A subclass, for Python dies of a plain one that struck in an extension module."""


def install() -> None:
    """Make Ctrl-C raise ``Interrupted`` and be remembered."""
    signal.signal(signal.SIGINT, _interrupt)


def check() -> None:
    """Raise ``Interrupted`` if Ctrl-C came before, whatever became of it."""
    if _seen:
        raise Interrupted


def ignore_from_now() -> None:
    """An impatient second Ctrl-C must not spoil the tidying."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)


def _interrupt(number: int, frame: FrameType | None) -> NoReturn:
    global _seen
    _seen = True
    raise Interrupted
