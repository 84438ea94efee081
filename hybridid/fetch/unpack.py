"""Extracts the wanted members of a zip archive, and checks all before any gets its name."""

from __future__ import annotations

import hashlib
import tempfile
import zipfile
from pathlib import Path

from hybridid.fetch.archive import PublicArchive, is_safe, sha256_of
from hybridid.naming import shortened

CHUNK = 1 << 20  # bytes


class CorruptArchiveError(Exception):
    """Raised if a file is not the published one."""


def unpack(source: PublicArchive, archive: Path, folder: Path) -> None:
    """Extract the members of ``source`` from the zip file ``archive`` into ``folder``: all of them or none.

    The paths are those of ``source``, never those that the archive gives.

    Raises:
        CorruptArchiveError: if the file is not a zip archive, has a path that leaves its folder, lacks
            a member, or has a SHA-256 that is not the published one.
    """
    if not zipfile.is_zipfile(archive):
        raise CorruptArchiveError(f"the server sent no zip archive{_beginning(archive)}")
    if source.sha256 is not None:
        _compare("the archive", sha256_of(archive), source.sha256)
    try:
        with (
            zipfile.ZipFile(archive) as zipped,
            tempfile.TemporaryDirectory(dir=folder, prefix=".") as scratch,
        ):
            unpacked = _unpacked(source, zipped, Path(scratch))
            for member, path in unpacked.items():
                target = folder / member
                target.parent.mkdir(parents=True, exist_ok=True)
                path.replace(target)
    except (CorruptArchiveError, OSError):
        raise
    except Exception as wrong:  # zipfile and the libraries below it raise errors of every kind
        reason = shortened(str(wrong), 200) or type(wrong).__name__
        raise CorruptArchiveError(f"the zip archive is broken: {reason}") from wrong


def _unpacked(source: PublicArchive, zipped: zipfile.ZipFile, scratch: Path) -> dict[str, Path]:
    """A checked temporary file for each member."""
    names = [info.filename for info in zipped.infolist() if not info.is_dir()]
    unsafe = [name for name in names if not is_safe(name)]
    if unsafe:
        raise CorruptArchiveError(f"the zip archive holds {unsafe[0]!r}, a path that leaves its folder")
    unpacked = {}
    for i, (member, published) in enumerate(source.members.items()):
        path = scratch / str(i)
        _compare(member, _extract(zipped, _entry(names, member), path, source.most), published)
        unpacked[member] = path
    return unpacked


def _entry(names: list[str], member: str) -> str:
    """The archive's name for ``member``: itself, or the shortest path that ends in it."""
    fitting = sorted((n for n in names if n == member or n.endswith(f"/{member}")), key=len)
    if not fitting:
        raise CorruptArchiveError(
            f"the zip archive holds no {member}; it holds {', '.join(names[:10]) or 'nothing'}"
        )
    return fitting[0]


def _extract(zipped: zipfile.ZipFile, entry: str, path: Path, most: int) -> str:
    """Write one entry of ``most`` bytes at most to ``path`` and return its SHA-256."""
    digest, left = hashlib.sha256(), most
    with zipped.open(entry) as content, path.open("wb") as file:
        while chunk := content.read(CHUNK):
            left -= len(chunk)
            if left < 0:
                raise CorruptArchiveError(
                    f"{entry} unpacks to more than {most / 1e6:g} MB, the file has less"
                )
            digest.update(chunk)
            file.write(chunk)
    return digest.hexdigest()


def _compare(what: str, found: str, published: str) -> None:
    if found != published:
        raise CorruptArchiveError(f"{what} has SHA-256 {found[:12]}..., published is {published[:12]}...")


def _beginning(archive: Path) -> str:
    with archive.open("rb") as file:
        head = file.read(64)
    return " but a web page" if b"<html" in head.lower() or b"<!doctype" in head.lower() else ""
