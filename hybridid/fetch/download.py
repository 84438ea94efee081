"""A file over http, continued where an earlier attempt was cut off."""

from __future__ import annotations

import re
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import requests

Progress = Callable[[int, int | None], None]  # bytes so far, bytes in all if the server says

TIMEOUT = (10.0, 60.0)  # s, to connect and between two packets
CHUNK = 16384  # bytes
MAXIMUM_CUTS = 20  # of one download, each after some progress
LONGEST = 3600.0  # s, of one download; the next goes on where it ended


class DownloadError(Exception):
    """Raised if a download does not finish; the bytes received are kept for the next attempt."""


class TooLargeError(Exception):
    """Raised if a server sends more bytes than the file may have."""


def download(url: str, part: Path, most: int, progress: Progress | None = None) -> None:
    """Download the file at ``url`` to ``part``; if ``part`` exists, only the missing bytes are requested.

    The file has ``most`` bytes at most, and the download takes ``LONGEST`` seconds at most.

    After a broken connection it tries again, as long as each attempt receives something. A server that
    does not support ranges sends the whole file, which replaces ``part``.

    Raises:
        DownloadError: with the reason, if there is no answer, a refusal, no more progress, or no more time.
        TooLargeError: if the server sends, or says that it will send, more than ``most`` bytes.
    """
    limits = _Limits(most, time.monotonic() + LONGEST)
    for _ in range(MAXIMUM_CUTS):
        before = _size(part)
        try:
            if _attempt(url, part, limits, progress):
                return
            reason = "the connection was cut"
        except (requests.RequestException, ValueError) as wrong:  # a redirect to no address is a ValueError
            reason = _reason(wrong)
        if _size(part) <= before:
            if not _size(part):
                part.unlink(missing_ok=True)
            raise DownloadError(reason)
    raise DownloadError(f"the connection was cut {MAXIMUM_CUTS} times")


def _attempt(url: str, part: Path, limits: _Limits, progress: Progress | None) -> bool:
    """One request for the missing bytes of ``part``; returns whether it is complete afterwards."""
    have = _size(part)
    headers = {"Accept-Encoding": "identity"}  # lengths and ranges count the file's own bytes
    if have:
        headers["Range"] = f"bytes={have}-"
    with requests.get(url, headers=headers, stream=True, timeout=TIMEOUT) as answer:
        if answer.status_code == requests.codes.requested_range_not_satisfiable and have:
            if answer.headers.get("Content-Range", "").endswith(f"/{have}"):
                return True
            part.unlink()  # longer than the file on the server, so not its beginning
            return _attempt(url, part, limits, progress)
        answer.raise_for_status()
        start = _start(answer)
        if start not in (0, have):
            raise requests.RequestException(f"asked from byte {have}, the server sent from byte {start}")
        length = answer.headers.get("Content-Length")
        total = start + int(length) if length and length.isdigit() else None
        limits.check(total or 0)
        _write(answer, part, start, total, limits, progress)
    return total is None or _size(part) == total


@dataclass(frozen=True)
class _Limits:
    """Of one download: its bytes, and the time when it ends, as ``time.monotonic`` counts."""

    most: int
    until: float

    def check(self, size: int) -> None:
        """Whether the download may go on after so many bytes."""
        if size > self.most:
            raise TooLargeError(f"the server sends more than {self.most / 1e6:g} MB, the file has less")
        if time.monotonic() > self.until:
            raise DownloadError(f"it took longer than {LONGEST / 60:.0f} min")


def _write(
    answer: requests.Response,
    part: Path,
    start: int,
    total: int | None,
    limits: _Limits,
    progress: Progress | None,
) -> None:
    done = start
    with part.open("ab" if start else "wb") as file:
        for chunk in answer.iter_content(CHUNK):
            file.write(chunk)
            done += len(chunk)
            limits.check(done)
            if progress is not None:
                progress(done, total)


def _start(answer: requests.Response) -> int:
    """Offset of the first byte of the answer."""
    if answer.status_code != requests.codes.partial_content:
        return 0
    found = re.match(r"bytes (\d+)-", answer.headers.get("Content-Range", ""))
    return int(found.group(1)) if found else 0


def _size(path: Path) -> int:
    return path.stat().st_size if path.exists() else 0


def _reason(wrong: requests.RequestException | ValueError) -> str:
    if not isinstance(wrong, requests.RequestException):
        return f"the server leads to an address that is none: {wrong}"
    if wrong.response is not None:
        return f"the server answered {wrong.response.status_code} {wrong.response.reason}"
    if isinstance(wrong, requests.Timeout):
        return "the server did not answer in time"
    if isinstance(wrong, requests.exceptions.SSLError):
        return "the server's certificate could not be verified"
    if isinstance(wrong, requests.exceptions.ChunkedEncodingError):
        return "the connection was cut"
    if isinstance(wrong, requests.exceptions.ContentDecodingError):
        return "the reply is not compressed in the way that the server says"
    if isinstance(wrong, requests.ConnectionError):
        return "there is no connection to the server"
    return " ".join(str(wrong).split())
