"""Runs that a process of this machine has begun in MLflow and not ended: each a folder with a locked file.

A process that is killed cannot end its runs, and on a full disk none can be ended. But the locks are freed:
the next command finds such runs (``left``).
"""

from __future__ import annotations

import hashlib
import platform
import shutil
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path

from filelock import FileLock, Timeout

from pipelines.shared.config import Settings
from pipelines.shared.errors import ConfigError
from pipelines.shared.storage import read_as, write_json
from pipelines.shared.tree import remove
from pipelines.tracking.store import store_folder, tracking_uri

_UNFINISHED = ".unfinished-"
_LOCK, _FILE = "lock", "run.json"
_MAKING = 3600.0
"""A folder that has no final name after so many seconds was left by a process that was killed."""


@dataclass(frozen=True)
class Begun:
    """A run by its ``key``; ``store`` is a digest of the store's address."""

    key: str
    experiment: str
    store: str
    machine: str


class Mark:
    """A file that says that a run is active in this process, until ``lift`` or the end of the process."""

    def __init__(self, key: str, experiment: str, settings: Settings, uri: str | None = None) -> None:
        root = _folder(settings)
        root.mkdir(parents=True, exist_ok=True)
        new = Path(tempfile.mkdtemp(prefix=_UNFINISHED, dir=root))
        self._lock = FileLock(str(new / _LOCK), thread_local=False)
        try:
            self._lock.acquire(timeout=0)
            begun = Begun(key, experiment, store_of(settings, uri), platform.node())
            write_json(new / _FILE, begun)
            # named when it is locked: nobody sees a mark without its lock
            self._place = new.rename(root / new.name.removeprefix(_UNFINISHED))
        except BaseException:  # a full disk
            self._lock.release(force=True)
            shutil.rmtree(new, ignore_errors=True)
            raise

    def lift(self) -> None:
        """Remove the mark: the run is ended, or stored to be sent later."""
        remove(self._place)
        self.leave()

    def leave(self) -> None:
        """Leave the mark: the next command ends the run, unless ``lift_left`` removes the mark."""
        self._lock.release(force=True)


@contextmanager
def marked(key: str, experiment: str, settings: Settings, uri: str | None = None) -> Iterator[None]:
    """A mark on the run for the duration of the context. After an exception the mark stays."""
    mark = Mark(key, experiment, settings, uri)
    try:
        yield
    except Exception:
        mark.leave()
        raise
    mark.lift()


def lift_left(key: str, settings: Settings) -> None:
    """Remove the marks that were left on the run ``key``, because it is stored to be sent later."""
    for place in _folder(settings).glob("[!.]*"):
        begun = _read(place)
        if begun is not None and begun.key == key and not _is_held(place):
            remove(place)


def left(settings: Settings) -> Iterator[Begun]:
    """Runs in this store whose process on this machine has ended. Each mark is removed when the loop
    continues; after an exception it stays."""
    root = _folder(settings)
    there = [place for place in root.glob("[!.]*") if place.is_dir()]
    held = {place: _read(place) for place in there}
    for place, begun in held.items():
        if begun is None or (begun.store, begun.machine) != (store_of(settings), platform.node()):
            continue
        lock = FileLock(str(place / _LOCK))
        with suppress(Timeout, FileNotFoundError):  # its process lives; another command was faster
            lock.acquire(timeout=0)
            try:
                others = (p for p, other in held.items() if p != place and other and other.key == begun.key)
                if not any(map(_is_held, others)):
                    yield begun
                remove(place)
            finally:
                lock.release()
    _clear(root)


def store_of(settings: Settings, uri: str | None = None) -> str:
    """A digest of the store's address."""
    return hashlib.sha256((uri or tracking_uri(settings)).encode()).hexdigest()[:16]


def _folder(settings: Settings) -> Path:
    return store_folder(settings) / ".mlflow-running"


def _read(place: Path) -> Begun | None:
    try:
        return read_as(Begun, place / _FILE)
    except (OSError, ConfigError, ValueError):
        return None  # lifted meanwhile


def _is_held(place: Path) -> bool:
    try:
        with FileLock(str(place / _LOCK), timeout=0):
            return False
    except Timeout:
        return True
    except OSError:
        return False


def _clear(root: Path) -> None:
    """Remove what processes left that were killed while they made or lifted a mark."""
    for place in root.glob(".*"):
        with suppress(OSError):
            if time.time() - place.stat().st_mtime > _MAKING:
                shutil.rmtree(place)
