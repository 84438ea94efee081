"""Compiled libraries kept from one process to the next, in the user's cache folder.

A trace compiles about a hundred models, and the same ones for each record of a machine. To load a library is
to run it. So it is loaded only from a folder that nobody else can change, and only if its seal is right: the
SHA-256 of its name and content, written behind the content in the same file. A library that was cut off or
damaged has no right seal and is compiled anew. To check one takes 0.1 to 0.3 ms.
"""

from __future__ import annotations

import ctypes
import itertools
import os
import tempfile
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path

from hybridid.private import cache_folder, content_of_sealed, sealed

MOST = 3000
"""Number of libraries that are kept, of about 50 kB each; the least recently used are removed first."""
OFTEN = 50
"""Libraries that a process makes from one look at their number to the next: a look takes 5 ms."""
SUFFIX = ".so"
_made = itertools.count()


def library(key: str, build: Callable[[Path], bool]) -> ctypes.CDLL | None:
    """The library called ``key``; if there is no sound one, ``build(file)`` makes it or returns False."""
    folder = cache_folder()
    kept = folder / f"{key[:40]}{SUFFIX}"
    if content_of_sealed(kept) is not None:
        with suppress(OSError):  # another process may remove it at the same time
            found = ctypes.CDLL(str(kept))
            os.utime(kept)
            return found
    with tempfile.TemporaryDirectory(prefix="making-", dir=folder) as own:
        made = Path(own) / kept.name
        if not build(made):
            return None
        made.chmod(0o600)
        made.write_bytes(sealed(kept.name, made.read_bytes()))  # what stands behind its end is never loaded
        found = ctypes.CDLL(str(made))
        made.replace(kept)  # written under another name first: other processes may be reading
    if next(_made) % OFTEN == 0:
        _prune(folder)
    return found


def _prune(folder: Path) -> None:
    """Remove the least recently used libraries where there are more than ``MOST``."""
    with suppress(OSError):  # another process may remove one at the same time
        kept = [folder / entry.name for entry in os.scandir(folder) if entry.name.endswith(SUFFIX)]
        if len(kept) > MOST:  # only then is each one's time asked for: that takes 50 ms
            for file in sorted(kept, key=lambda file: file.stat().st_mtime)[: MOST // 10]:
                file.unlink(missing_ok=True)
