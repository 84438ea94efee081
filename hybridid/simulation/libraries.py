"""Compiled libraries kept from one process to the next, in the user's cache folder.

A trace compiles some hundred models, the same ones whenever it looks at the same machine. A library that
cannot be kept or read there is made anew for this process alone.
"""

from __future__ import annotations

import ctypes
import functools
import os
import tempfile
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path

MOST = 3000
"""Libraries kept, of some 50 kB; those longest unused go first."""
SUFFIX = ".so"


def library(key: str, build: Callable[[Path], bool]) -> ctypes.CDLL | None:
    """The library called ``key``; if it is not there, ``build(file)`` makes it, or says False."""
    folder = _folder()
    kept = folder / f"{key[:40]}{SUFFIX}"
    with suppress(OSError):
        found = ctypes.CDLL(str(kept))
        os.utime(kept)
        return found
    with tempfile.TemporaryDirectory(prefix="making-", dir=folder) as own:
        made = Path(own) / kept.name
        if not build(made):
            return None
        made.replace(kept)  # whole or not at all: other processes may be reading
    _prune(folder)
    return ctypes.CDLL(str(kept))


@functools.cache
def _folder() -> Path:
    """``$XDG_CACHE_HOME/hybridid/models`` (by default in ``~/.cache``), else a folder of this process."""
    home = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "hybridid" / "models"
    try:
        home.mkdir(parents=True, exist_ok=True, mode=0o700)
        with tempfile.TemporaryDirectory(dir=home):
            return home
    except (OSError, RuntimeError):
        return Path(_of_this_process().name)


@functools.cache
def _of_this_process() -> tempfile.TemporaryDirectory[str]:
    """Gone when the process ends."""
    return tempfile.TemporaryDirectory(prefix="hybridid-")


def _prune(folder: Path) -> None:
    """Remove the libraries longest unused, now and then, so that there are never many more than ``MOST``."""
    with suppress(OSError):  # another process may be at it
        kept = sorted(folder.glob(f"*{SUFFIX}"), key=lambda file: file.stat().st_mtime)
        if len(kept) > MOST:
            for file in kept[: MOST // 10]:
                file.unlink(missing_ok=True)
