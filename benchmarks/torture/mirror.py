"""A slow server of a made archive, in the place of the published one: ``fetch`` needs no network here."""

from __future__ import annotations

import hashlib
import io
import re
import threading
import time
import zipfile
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, suppress
from functools import cache
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer

from hybridid.fetch import library
from hybridid.fetch.archive import PublicArchive

MEMBERS = {"DATA_EMPS.mat": 700_000, "DATA_EMPS_PULSES.mat": 300_000}
"""Sizes in bytes of the made members."""
PACKET, PAUSE = 16_384, 0.02


Answer = Callable[[BaseHTTPRequestHandler, bytes], None]
"""Answers a request, given the archive."""


@contextmanager
def mirror(archive: bytes | None = None, answer: Answer | None = None, most: int = 1 << 28) -> Iterator[None]:
    """Serve the made archive, or another in its place, on this machine, and let ``emps`` be it.

    ``answer`` answers in another way than slowly; ``most`` are the bytes that the archive may have.
    """
    archive = zipped(contents()) if archive is None else archive
    server = ThreadingHTTPServer(("127.0.0.1", 0), _answering(archive, answer or _slowly))
    threading.Thread(target=server.serve_forever, daemon=True).start()
    before = library.ARCHIVES
    made = PublicArchive(
        name="emps",
        url=f"http://127.0.0.1:{server.server_port}/emps.zip",
        page="http://127.0.0.1/",
        members={name: hashlib.sha256(content).hexdigest() for name, content in contents().items()},
        most=most,
    )
    library.ARCHIVES = (made,)
    try:
        yield
    finally:
        library.ARCHIVES = before
        server.shutdown()
        server.server_close()


@cache
def contents() -> Mapping[str, bytes]:
    """The members as they are published."""
    return {name: _made(name, size) for name, size in MEMBERS.items()}


def _made(name: str, size: int) -> bytes:
    """Bytes that do not compress."""
    block = hashlib.sha256(name.encode()).digest()
    parts = []
    while size > 0:
        block = hashlib.sha256(block).digest()
        parts.append(block[:size])
        size -= len(block)
    return b"".join(parts)


def zipped(members: Mapping[str, bytes]) -> bytes:
    """An archive of ``members``."""
    held = io.BytesIO()
    with zipfile.ZipFile(held, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in members.items():
            archive.writestr(zipfile.ZipInfo(name), content)
    return held.getvalue()


def _slowly(request: BaseHTTPRequestHandler, archive: bytes) -> None:
    """Send what is asked for, packet by packet."""
    asked = re.match(r"bytes=(\d+)-", request.headers.get("Range", ""))
    start = int(asked.group(1)) if asked else 0
    request.send_response(206 if asked else 200)
    if asked:
        request.send_header("Content-Range", f"bytes {start}-{len(archive) - 1}/{len(archive)}")
    request.send_header("Content-Length", str(len(archive) - start))
    request.end_headers()
    for k in range(start, len(archive), PACKET):
        request.wfile.write(archive[k : k + PACKET])
        time.sleep(PAUSE)


def _answering(archive: bytes, answer: Answer) -> type[BaseHTTPRequestHandler]:
    class Answers(BaseHTTPRequestHandler):
        def do_GET(self) -> None:
            with suppress(OSError):  # who asked is gone
                answer(self, archive)

        def log_message(self, *said: object) -> None:
            """Say nothing."""

    return Answers
