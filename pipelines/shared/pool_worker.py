"""A worker process of the pool: it takes calls from a pipe, and sends back their messages and results."""

from __future__ import annotations

import multiprocessing
import os
import pickle
import signal
import sys
import time
import traceback
import warnings
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from multiprocessing.connection import Connection
from pathlib import Path
from types import FrameType
from typing import Any, NoReturn

import hybridid
from pipelines.shared.own_code import make_importable
from pipelines.shared.parent_process import end_with
from pipelines.shared.watch import Watcher

BETWEEN = 0.2
"""Seconds between two reports of progress."""
KEPT = 4
"""Arguments that a worker keeps: a trace's horizons and the model that it adds to are two."""
_OURS = Path(hybridid.__file__).parent
ENDED = "ended"
"""The last message of a task: its result, or ``Lost``. All others are calls of a watcher's methods."""


@dataclass(frozen=True)
class Lost:
    """A task without a result: its process ended, or it raised ``error``."""

    reason: str
    error: Exception | None = None


@dataclass(frozen=True)
class Packed:
    """The pickled ``content`` of an argument that several calls share.

    A worker keeps the last ones unpickled: what a call derives from one (the functions of a model, the states
    that a record shows) serves the next.
    """

    content: bytes

    @property
    def unpacked(self) -> Any:
        """The argument."""
        return _kept(self.content)


@lru_cache(maxsize=KEPT)
def _kept(content: bytes) -> Any:
    return pickle.loads(content)  # noqa: S301  # nosec B301  # it comes from our own parent, by a pipe


class Stopped(BaseException):
    """The parent told this process to stop."""


class _PipeWatcher:
    """The watcher inside a worker: sends messages through the pipe; raises ``Stopped`` when told to stop."""

    def __init__(self, pipe: Connection) -> None:
        self._pipe = pipe
        self._last = ("", 0.0)

    def say(self, line: str) -> None:
        self._tell("say", line)

    def warn(self, line: str) -> None:
        self._tell("warn", line)

    def carry_on(self) -> None:
        if _stopped:
            raise Stopped

    def progress(self, work: str, state: str, fraction: float | None) -> None:
        self.carry_on()
        now = time.monotonic()
        if work != self._last[0] or now - self._last[1] > BETWEEN:
            self._last = (work, now)
            self._tell("progress", work, state, fraction)

    def _tell(self, kind: str, *said: Any) -> None:
        self.carry_on()
        self._pipe.send((kind, said))


_stopped = False


def _stop(number: int, frame: FrameType | None) -> NoReturn:
    """Raise ``Stopped``, and remember it, because a library may catch the exception."""
    global _stopped
    _stopped = True
    raise Stopped


def serve(pipe: Connection, environment: Mapping[str, str], folders: Sequence[Path]) -> None:
    """Do the tasks that come through ``pipe``, and send back their results, until it closes.

    The user's own code lies in ``folders``.
    """
    os.environ.update(environment)  # the server may have started before a setting was made
    make_importable(folders)
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the parent gets Ctrl-C too, and decides
    signal.signal(signal.SIGTERM, _stop)
    parent = multiprocessing.parent_process()
    assert parent is not None
    end_with(parent.join)
    warnings.showwarning = _shown_by(_PipeWatcher(pipe))
    try:
        while True:
            work, given = pipe.recv()
            pipe.send((ENDED, _outcome(work, given, _PipeWatcher(pipe))))
    except (EOFError, OSError, Stopped):
        signal.signal(signal.SIGTERM, signal.SIG_DFL)  # nothing is left to clean up


def _shown_by(watcher: Watcher) -> Callable[..., None]:
    """A function that passes warnings of hybridid to ``watcher`` and prints others as Python does."""

    def show(message: Warning | str, category: type[Warning], filename: str, lineno: int, *_: Any) -> None:
        if Path(filename).is_relative_to(_OURS):
            watcher.warn(str(message))
        else:
            sys.stderr.write(warnings.formatwarning(message, category, filename, lineno))

    return show


def _outcome(work: Callable[[Any, Watcher], Any], given: Any, watcher: Watcher) -> Any:
    """The result, or the exception with its traceback as a note, because pickling drops the traceback."""
    try:
        return work(given, watcher)
    except Exception as error:
        error.add_note(f"In a process of the pool:\n{traceback.format_exc()}")
        return Lost(" ".join(f"{type(error).__name__}: {error}".split()), error)
