"""The C compiler of this machine, if it has one, and the libraries that it makes.

It keeps to IEEE arithmetic (no fused or reordered operations), so each processor gives the same numbers.
"""

from __future__ import annotations

import ctypes
import errno
import functools
import hashlib
import os
import platform
import shutil
import subprocess
import warnings
from collections.abc import Callable
from pathlib import Path

from hybridid.simulation.libraries import library

# -fexpensive-optimizations also clears the wide registers before a call of the C library, which else is slow
FLAGS = ("-O1", "-fexpensive-optimizations", "-fPIC", "-shared", "-ffp-contract=off", "-Wno-psabi")
_FULL = "No space left on device"
"""What a compiler says of a full disk, in the language of C."""
_LIBRARIES: dict[str, ctypes.CDLL | None] = {}


@functools.cache
def c_compiler() -> str | None:
    """The C compiler: the one that CC names, or the first of the usual names on the PATH."""
    return next(filter(None, map(shutil.which, (os.environ.get("CC", ""), "cc", "gcc", "clang"))), None)


def compiled(said: str, source: Callable[[], str]) -> ctypes.CDLL | None:
    """The library of a C ``source`` of which ``said`` says all, from ``libraries`` where an earlier process
    has left it; None, with a warning, if the compiler fails."""
    compiler = str(c_compiler())
    key = hashlib.sha256("\0".join((compiler, platform.machine(), *_flags(), said)).encode()).hexdigest()
    if key not in _LIBRARIES:
        _LIBRARIES[key] = library(key, lambda made: _build(compiler, source(), made))
    return _LIBRARIES[key]


def forget() -> None:
    """Hold no library any more: the next one is looked for in ``libraries`` again, as a new process does."""
    _LIBRARIES.clear()


def _build(compiler: str, source: str, made: Path) -> bool:
    """Compile ``source`` into the file ``made``; False, with a warning, if that fails.

    Raises:
        OSError: if the disk is full. Interpreted, the same model has other last digits; so a command ends
            there, and has the same numbers when it is given again.
    """
    text = made.with_suffix(".c")
    text.write_text(source, encoding="utf-8")
    command = [compiler, *_flags(), str(text), "-o", str(made), "-lm"]
    beside = {**os.environ, "LC_ALL": "C", "TMPDIR": str(made.parent)}
    done = subprocess.run(command, capture_output=True, text=True, check=False, env=beside)
    text.unlink()
    if done.returncode:
        if _FULL in done.stderr:
            raise OSError(errno.ENOSPC, _FULL, str(made.parents[1]))
        why = (done.stderr.strip().splitlines() or ["no message"])[-1]
        warnings.warn(f"{compiler} fails ({why}): models are interpreted, which is slower", stacklevel=2)
    return done.returncode == 0


def widest() -> int:
    """Numbers that a register of this processor holds; 4 where two or more make up for one."""
    return 8 if {"avx512f", "avx512dq"} <= _features() else 4


@functools.cache
def _flags() -> tuple[str, ...]:
    """Of the compiler on this machine: four lanes, or eight, fit a register where the processor has them."""
    wide = ("avx2", "avx512f", "avx512dq") if widest() == 8 else ("avx2",)
    return (*FLAGS, *(f"-m{one}" for one in wide if one in _features()))


@functools.cache
def _features() -> frozenset[str]:
    """What this processor can do, in the words of Linux."""
    try:
        said = Path("/proc/cpuinfo").read_text(encoding="utf-8", errors="replace")
    except OSError:
        return frozenset()
    return frozenset(next((line.split() for line in said.splitlines() if line.startswith("flags")), ()))
