"""The user's own folders: what is kept there is believed later, so nobody else may be able to change it."""

from __future__ import annotations

import functools
import hashlib
import os
import stat
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:  # some of this takes as long to import as hybridid's --help takes in all
    import tempfile

KEPT = {"models": "compiled models", "unfinished": "results of interrupted commands"}
"""What is kept, by its folder."""
_SEAL = hashlib.sha256().digest_size
_WARNED = "HYBRIDID_CACHE_WARNED"
"""Set in the environment once the user has been warned: the processes that this one starts need not warn."""


@functools.cache
def cache_folder(kind: str = "models") -> Path:
    """``$XDG_CACHE_HOME/hybridid/kind`` (by default in ``~/.cache``; ``kind`` is one of ``KEPT``), if nobody
    else can change what lies there; else, with a warning, a folder of this process alone."""
    import tempfile
    import warnings

    home = _caches() / "hybridid" / kind
    try:
        home.mkdir(parents=True, exist_ok=True, mode=0o700)
        real = home.resolve(strict=True)  # a link could be turned elsewhere after it was looked at
        trouble = exposed(real)
        if not trouble:
            with tempfile.TemporaryDirectory(dir=real):
                return real
    except (OSError, RuntimeError) as error:
        trouble = f"{home} cannot be used: {getattr(error, 'strerror', None) or error}"
    if os.environ.get(_WARNED) != str(home.parent):
        os.environ[_WARNED] = str(home.parent)
        warnings.warn(f"{KEPT[kind]} are not kept: {trouble}", stacklevel=2)
    own = Path(_of_this_process().name) / kind
    own.mkdir(mode=0o700, exist_ok=True)
    return own


def keep_numba_private() -> None:
    """Give numba a folder of this process alone where others could change what it keeps.

    Numba unpickles what it finds beside the code or, where it cannot write there, in the user's cache folder,
    and checks neither.
    """
    kept = _caches() / "numba"
    with suppress(OSError, RuntimeError):
        if not os.access(Path(__file__).parent, os.W_OK) and kept.exists() and exposed(kept):
            os.environ.setdefault("NUMBA_CACHE_DIR", _of_this_process().name)


def exposed(folder: Path) -> str:
    """Why another user could change what lies in ``folder``; empty if nobody but its owner can.

    The folder must belong to the user, who alone may write to it. Those above must belong to the user or to
    root, and not everybody may replace what is in them (as in ``/tmp``, where only an owner may).
    """
    own = folder.stat()
    if own.st_uid != os.geteuid():
        return f"{folder} belongs to {_name(own.st_uid)}"
    if own.st_mode & (stat.S_IWGRP | stat.S_IWOTH):
        return f"others may write to {folder}; chmod go-w closes it"
    roots = {0, os.geteuid(), Path("/").stat().st_uid}  # in a container another number may stand for root
    for above in folder.resolve().parents:
        about = above.stat()
        if about.st_uid not in roots:
            return f"{above} belongs to {_name(about.st_uid)}"
        if about.st_mode & stat.S_IWOTH and not about.st_mode & stat.S_ISVTX:
            return f"everybody may write to {above}"
    return ""


def content_of_own(file: Path) -> bytes | None:
    """The content of a regular file that belongs to the user and that nobody else may write; else None."""
    try:
        with os.fdopen(os.open(file, os.O_RDONLY | os.O_NOFOLLOW | os.O_NONBLOCK), "rb") as stream:
            about = os.fstat(stream.fileno())
            if not stat.S_ISREG(about.st_mode) or about.st_uid != os.geteuid():
                return None
            return None if about.st_mode & (stat.S_IWGRP | stat.S_IWOTH) else stream.read()
    except OSError:
        return None


def sealed(name: str, content: bytes) -> bytes:
    """``content`` with its seal behind it: the SHA-256 of the file's ``name`` and the content."""
    return content + hashlib.sha256(name.encode() + b"\0" + content).digest()


def content_of_sealed(file: Path) -> bytes | None:
    """The content of a file of the user's own whose seal is right, without it; else None. A file that was cut
    off, damaged or given another name has no right seal."""
    whole = content_of_own(file)
    if whole is None or sealed(file.name, whole[:-_SEAL]) != whole:
        return None
    return whole[:-_SEAL]


def _caches() -> Path:
    return Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache")


@functools.cache
def _of_this_process() -> tempfile.TemporaryDirectory[str]:
    """A temporary folder that is removed when the process ends."""
    import tempfile

    return tempfile.TemporaryDirectory(prefix="hybridid-")


def _name(user: int) -> str:
    import pwd

    try:
        return pwd.getpwuid(user).pw_name
    except KeyError:
        return f"user {user}"
