"""Ctrl-C and requests to end (SIGTERM, SIGHUP): each raises ``Interrupted``.

It is remembered, for libraries may swallow the exception or disguise it: CasADi, struck while it converts
arguments, reports a wrong type instead. Python itself swallows what is raised in a destructor, and prints it:
there it is raised again, a moment later.
"""

from __future__ import annotations

import signal
import sys
import time
from types import FrameType
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from sys import UnraisableHookArgs

SAID = {
    signal.SIGINT: "interrupted",
    signal.SIGTERM: "told to end (SIGTERM)",
    signal.SIGHUP: "the terminal is closed (SIGHUP)",
}
"""The signals that ask a command to end, and what it then says."""
AGAIN = 0.05
"""Seconds after which a swallowed signal is raised again."""
ONE_PRESS = 1.0
"""Seconds within which a second signal is the first again: from the terminal, and passed on by a wrapper."""

_seen: signal.Signals | None = None
_when = 0.0


class Interrupted(KeyboardInterrupt):
    """A signal asks to end. A subclass, for Python dies of a plain one that struck in an extension module."""

    def __init__(self, number: int = signal.SIGINT) -> None:
        self.signal = signal.Signals(number)
        super().__init__(SAID[self.signal])

    @property
    def code(self) -> int:
        """The exit code, as a shell gives it to a command that a signal ended: 130, 143 or 129."""
        return 128 + self.signal


def install() -> None:
    """Make the signals raise ``Interrupted`` and be remembered; ``nohup`` keeps its word."""
    for number in SAID:
        if number != signal.SIGHUP or signal.getsignal(number) != signal.SIG_IGN:
            signal.signal(number, _interrupt)
    signal.signal(signal.SIGALRM, _interrupt_again)
    sys.unraisablehook = _swallowed


def check() -> None:
    """Raise ``Interrupted`` if a signal came before, whatever became of it."""
    if _seen is not None:
        raise Interrupted(_seen)


def last() -> Interrupted:
    """The signal that came, by whatever exception it is known: CasADi raises one of its own."""
    return Interrupted(_seen or signal.SIGINT)


def ignore_from_now() -> None:
    """An impatient second Ctrl-C must not spoil the tidying, nor a first one the end."""
    for number in (*SAID, signal.SIGALRM):
        signal.signal(number, signal.SIG_IGN)


def _interrupt(number: int, frame: FrameType | None) -> None:
    global _seen, _when
    again = _seen is not None and time.monotonic() - _when < ONE_PRESS
    if not again:
        _seen, _when = signal.Signals(number), time.monotonic()
        raise Interrupted(number)


def _interrupt_again(number: int, frame: FrameType | None) -> None:
    raise last()


def _swallowed(what: UnraisableHookArgs) -> None:
    """Print what nobody can catch, unless it is an interrupt: that is raised again where it can be caught."""
    if isinstance(what.exc_value, Interrupted):
        signal.setitimer(signal.ITIMER_REAL, AGAIN)
    else:
        sys.__unraisablehook__(what)
