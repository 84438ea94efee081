"""Compiled libraries kept from one process to the next, in the user's cache folder.

A trace compiles about a hundred models, and the same ones for each record of a machine. A library that
cannot be written or read there is compiled for this process only.
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
"""Number of libraries that are kept, of about 50 kB each; the least recently used are removed first."""
SUFFIX = ".so"


def library(key: str, build: Callable[[Path], bool]) -> ctypes.CDLL | None:
    """The library called ``key``; if it is missing, ``build(file)`` makes it or returns False."""
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
        made.replace(kept)  # written under another name first: other processes may be reading
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
    """A temporary folder that is removed when the process ends."""
    return tempfile.TemporaryDirectory(prefix="hybridid-")


def _prune(folder: Path) -> None:
    """Remove the least recently used libraries from time to time, down to ``MOST``."""
    with suppress(OSError):  # another process may remove it at the same time
        kept = sorted(folder.glob(f"*{SUFFIX}"), key=lambda file: file.stat().st_mtime)
        if len(kept) > MOST:
            for file in kept[: MOST // 10]:
                file.unlink(missing_ok=True)
