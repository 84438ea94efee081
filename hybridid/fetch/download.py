"""A file over http, continued where an earlier attempt was cut off."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

import requests

Progress = Callable[[int, int | None], None]  # bytes so far, bytes in all if the server says

TIMEOUT = (10.0, 60.0)  # s, to connect and between two packets
CHUNK = 16384  # bytes
MAXIMUM_CUTS = 20  # of one download, each after some progress


class DownloadError(Exception):
    """Raised if a download does not finish; the bytes received are kept for the next attempt."""


def download(url: str, part: Path, progress: Progress | None = None) -> None:
    """Download the file at ``url`` to ``part``; if ``part`` exists, only the missing bytes are requested.

    After a broken connection it tries again, as long as each attempt receives something. A server that
    does not support ranges sends the whole file, which replaces ``part``.

    Raises:
        DownloadError: with the reason, if there is no answer, a refusal, or no more progress.
    """
    for _ in range(MAXIMUM_CUTS):
        before = _size(part)
        try:
            if _attempt(url, part, progress):
                return
            reason = "the connection was cut"
        except requests.RequestException as wrong:
            reason = _reason(wrong)
        if _size(part) <= before:
            raise DownloadError(reason)
    raise DownloadError(f"the connection was cut {MAXIMUM_CUTS} times")


def _attempt(url: str, part: Path, progress: Progress | None) -> bool:
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
            return _attempt(url, part, progress)
        answer.raise_for_status()
        start = _start(answer)
        if start not in (0, have):
            raise requests.RequestException(f"asked from byte {have}, the server sent from byte {start}")
        length = answer.headers.get("Content-Length")
        total = start + int(length) if length and length.isdigit() else None
        _write(answer, part, start, total, progress)
    return total is None or _size(part) == total


def _write(
    answer: requests.Response, part: Path, start: int, total: int | None, progress: Progress | None
) -> None:
    done = start
    with part.open("ab" if start else "wb") as file:
        for chunk in answer.iter_content(CHUNK):
            file.write(chunk)
            done += len(chunk)
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


def _reason(wrong: requests.RequestException) -> str:
    if wrong.response is not None:
        return f"the server answered {wrong.response.status_code} {wrong.response.reason}"
    if isinstance(wrong, requests.Timeout):
        return "the server did not answer in time"
    if isinstance(wrong, requests.exceptions.SSLError):
        return "the server's certificate could not be verified"
    if isinstance(wrong, requests.exceptions.ChunkedEncodingError):
        return "the connection was cut"
    if isinstance(wrong, requests.ConnectionError):
        return "there is no connection to the server"
    return " ".join(str(wrong).split())
