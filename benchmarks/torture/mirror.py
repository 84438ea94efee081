"""A slow server of a made archive, in the place of the published one: ``fetch`` needs no network here."""

from __future__ import annotations

import hashlib
import io
import re
import threading
import time
import zipfile
from collections.abc import Iterator
from contextlib import contextmanager
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer

from hybridid.fetch import library
from hybridid.fetch.archive import PublicArchive

MEMBERS = {"DATA_EMPS.mat": 700_000, "DATA_EMPS_PULSES.mat": 300_000}
"""Sizes in bytes of the made members."""
PACKET, PAUSE = 16_384, 0.02


@contextmanager
def mirror() -> Iterator[None]:
    """Serve the made archive on this machine, and let ``emps`` be it."""
    contents = {name: _made(name, size) for name, size in MEMBERS.items()}
    archive = _zipped(contents)
    server = ThreadingHTTPServer(("127.0.0.1", 0), _answering(archive))
    threading.Thread(target=server.serve_forever, daemon=True).start()
    before = library.ARCHIVES
    made = PublicArchive(
        name="emps",
        url=f"http://127.0.0.1:{server.server_port}/emps.zip",
        page="http://127.0.0.1/",
        members={name: hashlib.sha256(content).hexdigest() for name, content in contents.items()},
    )
    library.ARCHIVES = (made,)
    try:
        yield
    finally:
        library.ARCHIVES = before
        server.shutdown()
        server.server_close()


def _made(name: str, size: int) -> bytes:
    """Bytes that do not compress."""
    block = hashlib.sha256(name.encode()).digest()
    parts = []
    while size > 0:
        block = hashlib.sha256(block).digest()
        parts.append(block[:size])
        size -= len(block)
    return b"".join(parts)


def _zipped(contents: dict[str, bytes]) -> bytes:
    held = io.BytesIO()
    with zipfile.ZipFile(held, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in contents.items():
            archive.writestr(zipfile.ZipInfo(name), content)
    return held.getvalue()


def _answering(archive: bytes) -> type[BaseHTTPRequestHandler]:
    class Answers(BaseHTTPRequestHandler):
        def do_GET(self) -> None:
            asked = re.match(r"bytes=(\d+)-", self.headers.get("Range", ""))
            start = int(asked.group(1)) if asked else 0
            self.send_response(206 if asked else 200)
            if asked:
                self.send_header("Content-Range", f"bytes {start}-{len(archive) - 1}/{len(archive)}")
            self.send_header("Content-Length", str(len(archive) - start))
            self.end_headers()
            try:
                for k in range(start, len(archive), PACKET):
                    self.wfile.write(archive[k : k + PACKET])
                    time.sleep(PAUSE)
            except OSError:
                return  # who asked is gone

        def log_message(self, *said: object) -> None:
            """Say nothing."""

    return Answers
