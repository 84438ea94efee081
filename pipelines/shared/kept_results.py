"""Results of the parts of long computations, stored for a week, so that no part is computed twice.

A computation passes its work to a mapper, as functions with arguments. The function and the content of its
arguments identify a result (``content_digest``), and the ``key`` of a folder says by which code, and for
which run. So a computation goes on where it was interrupted or a time limit ended it, and another one about
the same records takes what they have in common. The process that computes a result writes it at once. The
files lie in the user's private cache and end with a checksum (``hybridid.private``), because unpickling a
file from elsewhere could run code.
"""

from __future__ import annotations

import os
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
from pipelines.shared.content_digest import content_digest
from pipelines.shared.tree import write_bytes

CLOCK = ".seconds"
"""The file that tells how long an interrupted computation took."""
DAYS = 7
"""Results that were not used for so many days are removed."""
MOST = 2 * 10**9
"""Bytes of all results together; those that were not used for longest are removed first."""


@dataclass(frozen=True)
class KeptResults:
    """A mapper's results are stored in ``folder``. ``before`` are the seconds that the computation took until
    it was interrupted."""

    folder: Path
    before: float

    def __call__(self, mapper: Mapper) -> Mapper:
        """A mapper that stores its results."""

        def keeping(function: Callable[..., object], arguments: Iterable[tuple[Any, ...]]) -> Iterable[Any]:
            given = ((_name_of(function, one), *one) for one in arguments)
            return mapper(_Kept(function, self.folder), given)

        return keeping


@contextmanager
def kept_results(key: str, anew: bool, say: Callable[[str], None]) -> Iterator[KeptResults]:
    """Yields what makes a mapper store its results, and take those that are stored under this ``key``
    already, unless ``anew`` is set."""
    began = time.monotonic()
    home = cache_folder("results")
    _prune(home)
    folder = home / key
    if anew or (folder.is_dir() and exposed(folder)):  # somebody else may have put results there
        shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(mode=0o700, exist_ok=True)
    os.utime(folder)
    clock = folder / CLOCK
    before = _seconds_in(clock)
    if found := sum(1 for file in folder.iterdir() if not file.name.startswith(".")):
        kept = f"{found} results are kept"
        say(f"goes on where it was interrupted: {kept}" if before else f"{kept}: none is computed again")
    try:
        yield KeptResults(folder, before)
    except BaseException:
        with suppress(OSError):
            write_bytes(clock, str(before + time.monotonic() - began).encode(), 0o600)
        raise
    clock.unlink(missing_ok=True)


def _seconds_in(file: Path) -> float:
    """The number in the ``file``; 0 where there is none."""
    try:
        return float(file.read_text())
    except (OSError, ValueError):
        return 0.0


@dataclass(frozen=True)
class _Kept:
    """``function``, whose result is taken from ``folder`` if it is kept there under the name of the call."""

    function: Callable[..., Any]
    folder: Path

    @property
    def __name__(self) -> str:
        return str(getattr(self.function, "__name__", type(self.function).__name__))

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


def _name_of(function: Callable[..., Any], given: tuple[Any, ...]) -> str:
    """Of the file that keeps the result of ``function`` for the arguments ``given``."""
    where = (getattr(function, "__module__", ""), getattr(function, "__qualname__", ""))
    return f"{where[1].rpartition('.')[2]}-{content_digest((*where, given))}"


def _prune(home: Path) -> None:
    """Remove the results of ``home`` that were not used for long, or for which there is no room."""
    last, room = time.time() - 86400 * DAYS, MOST
    with suppress(OSError):  # another process may remove one at the same time
        for folder in sorted(home.iterdir(), key=lambda one: one.stat().st_mtime, reverse=True):
            room -= sum(entry.stat().st_size for entry in os.scandir(folder))
            if folder.stat().st_mtime < last or room < 0:
                shutil.rmtree(folder, ignore_errors=True)
