"""``fetch``: the files of a public archive, downloaded unless they are on this machine."""

from __future__ import annotations

from pathlib import Path
from urllib.parse import urlsplit

from filelock import FileLock

from hybridid.fetch.archive import FetchError, PublicArchive, sha256_of
from hybridid.fetch.download import DownloadError, Progress, TooLargeError, download
from hybridid.fetch.unpack import CorruptArchiveError, unpack


def fetch(source: PublicArchive, cache: Path, progress: Progress | None = None) -> list[Path]:
    """The paths ``cache/<name of source>/<member>`` of all members, each the published file bit for bit.

    Files that exist are checked and not downloaded again. An interrupted download continues where it
    ended, in this call or the next. Files get their names only after all are checked. A wrong download is
    deleted. ``progress`` is called with the bytes received and, if known, the total.

    Raises:
        FetchError: in one line, with the page to visit, if the archive cannot be downloaded or is not
            the published one, or if another file has the name of a member; that file is not changed.
    """
    folder = Path(cache) / source.name
    paths = [folder / member for member in source.members]
    if _present(source, folder):
        return paths
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with FileLock(folder / ".lock"):
            if not _present(source, folder):  # another process may have fetched them meanwhile
                _obtain(source, folder, progress)
    except OSError as wrong:
        raise FetchError(f"{source.name}: cannot write to {folder}: {wrong.strerror or wrong}") from wrong
    return paths


def _present(source: PublicArchive, folder: Path) -> bool:
    """Whether all members are there.

    Raises:
        FetchError: if one has other content; it may be a user's own file and is not replaced.
    """
    missing = 0
    for member, published in source.members.items():
        path = folder / member
        if not path.exists():
            missing += 1
        elif (found := sha256_of(path)) != published:
            raise FetchError(
                f"{path} is not the published file (SHA-256 {found[:12]}..., published {published[:12]}...); "
                "fetch replaces no file: move it away and fetch again"
            )
    return missing == 0


def _obtain(source: PublicArchive, folder: Path, progress: Progress | None) -> None:
    part = folder / f".{source.name}.part"
    resumed = part.exists()
    for fresh in (not resumed, True):
        try:
            download(source.url, part, source.most, progress)
            unpack(source, part, folder)
        except DownloadError as wrong:
            host = urlsplit(source.url).hostname
            kept = f" ({part.stat().st_size} bytes are kept, fetch again to resume)" if part.exists() else ""
            raise FetchError(f"{source.name} from {host}: {wrong}{kept}; {source.by_hand(folder)}") from wrong
        except (CorruptArchiveError, TooLargeError) as wrong:
            part.unlink(missing_ok=True)
            if fresh:
                raise FetchError(f"{source.name}: {wrong}; deleted; {source.by_hand(folder)}") from wrong
            continue  # the bytes kept from an earlier call may be of another file: try once more without them
        part.unlink()
        return
