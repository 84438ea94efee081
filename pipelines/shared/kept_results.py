"""Results of a long computation, stored while it runs, so that it can continue after an interruption.

A deterministic computation that passes all its work to a mapper makes the same calls in the same order each
time. So the place in that order, and the ``key`` of all inputs of the computation, identify a result. The
process that computes a result writes it at once. The files lie in the user's private cache and end with a
checksum (``hybridid.private``), because unpickling a file from elsewhere could run code.
"""

from __future__ import annotations

import pickle
import shutil
import time
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from hybridid.private import cache_folder, content_of_sealed, exposed, sealed
from hybridid.trace.mapper import Mapper
from pipelines.shared.tree import write_bytes

CLOCK = ".seconds"
"""The file that tells how long an interrupted computation took."""
DAYS = 7
"""Results that were not used for so many days are removed."""


@dataclass(frozen=True)
class Unfinished:
    """A computation whose results are stored in ``folder``; ``before`` are the seconds that it took until it
    was interrupted."""

    folder: Path
    before: float

    def __call__(self, mapper: Mapper) -> Mapper:
        """A mapper that stores its results."""
        return _Keeping(mapper, self.folder)


@contextmanager
def kept_results(key: str, anew: bool, say: Callable[[str], None]) -> Iterator[Unfinished]:
    """Yields the computation ``key``, which makes a mapper store its results.

    The results are removed at the end. After an exception they stay, and the next computation with this
    ``key`` uses them, unless ``anew`` is set.
    """
    began = time.monotonic()
    home = cache_folder("unfinished")
    _prune(home)
    folder = home / key
    if anew or (folder.is_dir() and exposed(folder)):  # somebody else may have put results there
        shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(mode=0o700, exist_ok=True)
    if found := sum(1 for file in folder.iterdir() if not file.name.startswith(".")):
        say(f"continues where it was interrupted: {found} results are kept")
    clock = folder / CLOCK
    before = _seconds_in(clock)
    try:
        yield Unfinished(folder, before)
    except BaseException:
        with suppress(OSError):
            write_bytes(clock, str(before + time.monotonic() - began).encode(), 0o600)
        raise
    shutil.rmtree(folder, ignore_errors=True)


def _seconds_in(file: Path) -> float:
    """The number in the ``file``; 0 where there is none."""
    try:
        return float(file.read_text())
    except (OSError, ValueError):
        return 0.0


class _Keeping:
    """A mapper whose results are kept in ``folder``."""

    def __init__(self, mapper: Mapper, folder: Path) -> None:
        self._mapper, self._folder, self._calls = mapper, folder, 0

    def __call__(
        self, function: Callable[..., object], arguments: Iterable[tuple[Any, ...]]
    ) -> Iterable[Any]:
        self._calls += 1
        call = f"{self._calls}-{_name(function)}"
        given = ((f"{call}-{k}", *one) for k, one in enumerate(arguments))
        return self._mapper(_Kept(function, self._folder), given)


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
