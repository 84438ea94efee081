"""Ctrl-C and requests to end (SIGTERM, SIGHUP): each raises ``Interrupted``.

A library may catch the exception or raise another one in its place. CasADi, for example, reports a wrong type
if the signal arrives while it converts arguments. So this module remembers the signal. Python prints an
exception that a destructor raises and does not pass it on. In that case the signal is raised again ``AGAIN``
seconds later.
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
"""The signals that ask a command to end, each with the message that the command prints."""
AGAIN = 0.05
"""Seconds after which a swallowed signal is raised again."""
ONE_PRESS = 1.0
"""Seconds within which a second signal is ignored. After one Ctrl-C the signal may arrive twice: from the
terminal, and from a wrapper that passes it on."""

_seen: signal.Signals | None = None
_when = 0.0


class Interrupted(KeyboardInterrupt):
    """A signal asks the command to end.

    It is a subclass of ``KeyboardInterrupt``, because Python itself ends the process after a plain one from
    an extension module.
    """

    def __init__(self, number: int = signal.SIGINT) -> None:
        self.signal = signal.Signals(number)
        super().__init__(SAID[self.signal])

    @property
    def code(self) -> int:
        """The exit code, as a shell gives it to a command that a signal ended: 130, 143 or 129."""
        return 128 + self.signal


def install() -> None:
    """Make the signals of ``SAID`` raise ``Interrupted``, and remember the last one.

    Under ``nohup`` SIGHUP is already ignored, and it stays ignored.
    """
    for number in SAID:
        if number != signal.SIGHUP or signal.getsignal(number) != signal.SIG_IGN:
            signal.signal(number, _interrupt)
    signal.signal(signal.SIGALRM, _interrupt_again)
    sys.unraisablehook = _swallowed


def check() -> None:
    """Raise ``Interrupted`` if a signal came earlier, even if a library caught its exception."""
    if _seen is not None:
        raise Interrupted(_seen)


def last() -> Interrupted:
    """The signal that came, as an exception. It may differ from the exception that was caught, because CasADi
    raises its own."""
    return Interrupted(_seen or signal.SIGINT)


def ignore_from_now() -> None:
    """Ignore all further signals, so that none of them interrupts the clean-up or the exit."""
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
    """Print an exception that cannot be caught. An interrupt is raised again, at a place where it can be."""
    if isinstance(what.exc_value, Interrupted):
        signal.setitimer(signal.ITIMER_REAL, AGAIN)
    else:
        sys.__unraisablehook__(what)
