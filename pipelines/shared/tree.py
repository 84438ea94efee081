"""A run's folder: its path, its lock, and stage folders that are replaced in one step."""

from __future__ import annotations

import os
import shutil
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

from filelock import FileLock, Timeout

from pipelines.shared.config import Settings, digest

_UNFINISHED = ".unfinished-"
_REPLACED = ".replaced-"


def tree_of(settings: Settings, simulated: bool) -> Path:
    """The run tree: ``out`` (in a sweep: ``out``/<digest>), else ``paths.outputs``/<case>/<digest>.

    Results from a virtual rig never replace measured ones: their folder's name ends in ``-simulated``.
    """
    name = f"{digest(settings)}-simulated" if simulated else digest(settings)
    out = settings.get("out")
    if out is not None:
        return Path(str(out)) / name if settings.in_sweep else Path(str(out))
    return settings.outputs / settings.case / name


@contextmanager
def locked(root: Path, waiting: Callable[[str], None]) -> Iterator[None]:
    """Lock the tree for this process. While another process holds it, report so once and wait.

    Unfinished folders of an earlier process that was killed are removed.
    """
    root.mkdir(parents=True, exist_ok=True)
    lock = FileLock(str(root / ".lock"))
    try:
        lock.acquire(timeout=0.2)
    except Timeout:
        waiting(f"waiting: another hybridid process is writing in {root}")
        lock.acquire()
    try:
        _clear(root)
        yield
    finally:
        _clear(root)  # an interrupt may come after a folder is made and before its ``try`` begins
        lock.release()


def _clear(root: Path) -> None:
    """Remove unfinished folders; only the holder of the lock may call this."""
    for prefix in (_UNFINISHED, _REPLACED):
        for left in (*root.glob(f"{prefix}*"), *root.glob(f"*/{prefix}*")):
            shutil.rmtree(left, ignore_errors=True)


@contextmanager
def replacing(folder: Path, within: Path | None = None) -> Iterator[Path]:
    """A new folder to write in. It replaces ``folder`` at the end, or is removed after an exception.

    Until then it lies in ``within`` (None: beside ``folder``).
    """
    new = Path(tempfile.mkdtemp(prefix=f"{_UNFINISHED}{folder.name}-", dir=within or folder.parent))
    new.chmod(0o755)
    try:
        yield new
        remove(folder)
        folder.parent.mkdir(exist_ok=True)
        new.rename(folder)
    finally:
        shutil.rmtree(new, ignore_errors=True)


def discard_unfinished(folder: Path) -> None:
    """Remove what a command that was killed left of its attempt at ``folder``."""
    for left in folder.parent.glob(f"{_UNFINISHED}{folder.name}-*"):
        shutil.rmtree(left, ignore_errors=True)


def remove(folder: Path) -> bool:
    """Remove a stage's folder in one step, so that no part of it remains; False if there is none."""
    if not folder.exists():
        return False
    old = Path(tempfile.mkdtemp(prefix=_REPLACED, dir=folder.parent))
    folder.rename(old / folder.name)
    shutil.rmtree(old, ignore_errors=True)
    return True


def write_text(path: Path, text: str, mode: int = 0o644) -> None:
    """Write a file in one step: a reader sees the old text or the new one, never a part."""
    write_bytes(path, text.encode(), mode)


def write_bytes(path: Path, content: bytes, mode: int = 0o644) -> None:
    """Write a file with these permissions in one step, as ``write_text`` does."""
    handle, name = tempfile.mkstemp(prefix=f".{path.name}-", dir=path.parent)
    try:
        with os.fdopen(handle, "wb") as stream:
            stream.write(content)
        Path(name).chmod(mode)
        Path(name).replace(path)
    except BaseException:
        Path(name).unlink(missing_ok=True)
        raise


def point_latest(root: Path) -> None:
    """Let the link ``latest`` beside ``root`` point to it."""
    link = root.parent / "latest"
    new = root.parent / f".latest-{os.getpid()}"
    if link.exists() and not link.is_symlink():
        return  # a user's own folder of this name
    new.unlink(missing_ok=True)
    new.symlink_to(root.name, target_is_directory=True)
    new.replace(link)


def point_to(link: Path, folder: Path) -> None:
    """Let ``link`` lead to ``folder``, which lies below the link's own folder, in one step."""
    new = link.with_name(f".{link.name}-link")
    new.unlink(missing_ok=True)
    new.symlink_to(folder.relative_to(link.parent), target_is_directory=True)
    new.replace(link)
