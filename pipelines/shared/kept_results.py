"""Results of a long computation, stored while it runs, so that it can continue after an interruption.

A deterministic computation that passes all its work to a mapper calls it with each function in the same order
each time. So the ``key`` of all inputs of the computation, the function, the number of the call and the name
of what it is called with identify a result. Until a time limit leaves something out, a computation with one
does the same, in another order within a call. What follows is neither stored nor taken. The process that
computes a result writes it at once. The files lie in the user's private cache and end with a
checksum (``hybridid.private``), because unpickling a file from elsewhere could run code.
"""

from __future__ import annotations

import pickle
import shutil
import time
from collections import Counter
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from urllib.parse import quote

from hybridid.private import cache_folder, content_of_sealed, exposed, sealed
from hybridid.trace.deadline import Deadline
from hybridid.trace.mapper import Mapper
from pipelines.shared.tree import write_bytes

CLOCK = ".seconds"
"""The file that tells how long an interrupted computation took."""
DAYS = 7
"""Results that were not used for so many days are removed."""


@dataclass(frozen=True)
class Unfinished:
    """A computation whose results are stored in ``folder``; ``before`` are the seconds that it took until it
    was interrupted, or a time limit ended it."""

    folder: Path
    before: float
    deadline: Deadline

    def __call__(self, mapper: Mapper) -> Mapper:
        """A mapper that stores its results until the ``deadline`` has left something out."""
        return _Keeping(mapper, self)


@contextmanager
def kept_results(
    key: str, anew: bool, say: Callable[[str], None], deadline: Deadline | None = None
) -> Iterator[Unfinished]:
    """Yields the computation ``key``, which makes a mapper store its results.

    The results are removed at the end. They stay after an exception, and if the ``deadline`` has left
    something out. The next computation with this ``key`` uses them, unless ``anew`` is set.
    """
    began, deadline = time.monotonic(), deadline or Deadline()
    home = cache_folder("unfinished")
    _prune(home)
    folder = home / key
    if anew or (folder.is_dir() and exposed(folder)):  # somebody else may have put results there
        shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(mode=0o700, exist_ok=True)
    if found := sum(1 for file in folder.iterdir() if not file.name.startswith(".")):
        say(f"continues where it ended: {found} results are kept")
    clock = folder / CLOCK
    before, done = _seconds_in(clock), False
    try:
        yield Unfinished(folder, before, deadline)
        done = not deadline.left_out
    finally:
        if done:
            shutil.rmtree(folder, ignore_errors=True)
        else:
            with suppress(OSError):
                write_bytes(clock, str(before + time.monotonic() - began).encode(), 0o600)


def _seconds_in(file: Path) -> float:
    """The number in the ``file``; 0 where there is none."""
    try:
        return float(file.read_text())
    except (OSError, ValueError):
        return 0.0


class _Keeping:
    """A mapper whose results are kept in the folder of ``unfinished``."""

    def __init__(self, mapper: Mapper, unfinished: Unfinished) -> None:
        self._mapper, self._unfinished = mapper, unfinished
        self._calls: Counter[str] = Counter()

    def __call__(
        self, function: Callable[..., object], arguments: Iterable[tuple[Any, ...]]
    ) -> Iterable[Any]:
        if self._unfinished.deadline.left_out:
            return self._mapper(function, arguments)
        name = _name(function)
        self._calls[name] += 1
        kept = _Kept(function, self._unfinished.folder)
        return self._mapper(kept, _each_named(f"{name}-{self._calls[name]}", arguments))


def _each_named(call: str, arguments: Iterable[tuple[Any, ...]]) -> Iterator[tuple[Any, ...]]:
    """Each of ``arguments`` behind a name of its own: that of its first one, if it has one, and a number."""
    named: Counter[str] = Counter()
    for one in arguments:
        own = quote(str(getattr(one[0], "name", "")) if one else "", safe="")
        named[own] += 1
        yield f"{call}-{own}-{named[own]}", *one


@dataclass(frozen=True)
class _Kept:
    """``function``, whose result is taken from ``folder`` if it is kept there under the name of the call."""

    function: Callable[..., Any]
    folder: Path

    @property
    def __name__(self) -> str:
        return _name(self.function)

    def __call__(self, name: str, *given: Any) -> Any:
        file = self.folder / name
        content = content_of_sealed(file)
        if content is not None:
            # the user's own file, sealed, in a closed folder
            return pickle.loads(content)  # noqa: S301  # nosec B301
        result = self.function(*given)
        with suppress(OSError):  # a full disk costs the copy, not the result
            write_bytes(file, sealed(name, pickle.dumps(result)), 0o600)
        return result


def _name(function: Callable[..., Any]) -> str:
    return getattr(function, "__name__", type(function).__name__)


def _prune(home: Path) -> None:
    last = time.time() - 86400 * DAYS
    for folder in home.iterdir():
        with suppress(OSError):  # another process may remove it at the same time
            if folder.stat().st_mtime < last:
                shutil.rmtree(folder, ignore_errors=True)
