"""A web site on this machine that hands out one archive, and misbehaves as a test asks it to."""

from __future__ import annotations

import hashlib
import io
import re
import threading
import zipfile
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from hybridid.fetch import FetchError, PublicArchive

FILES = {name: np.random.default_rng(i).bytes(150_000) for i, name in enumerate(("one.mat", "sub/two.csv"))}
PAGE = "https://example.org/benchmark"


def zipped(files: Mapping[str, bytes]) -> bytes:
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in files.items():
            archive.writestr(zipfile.ZipInfo(name), content, zipfile.ZIP_DEFLATED)
    return buffer.getvalue()


def sha256(content: bytes) -> str:
    return hashlib.sha256(content).hexdigest()


@dataclass
class Site:
    """A web site of one file, and how it misbehaves."""

    content: bytes = field(default_factory=lambda: zipped(FILES))
    port: int = 0
    cut_after: list[int] = field(default_factory=list)  # bytes sent of each of the first answers
    ranges: bool = True
    chunked: bool = False
    status: int = 200
    header: Mapping[str, str] = field(default_factory=dict)  # more of it
    requests: list[str | None] = field(default_factory=list)  # the Range header of each
    files: Mapping[str, bytes] = field(default_factory=lambda: FILES)
    page: str = PAGE

    @property
    def url(self) -> str:
        return f"http://127.0.0.1:{self.port}/data.zip"

    def archive(self, **changes: Any) -> PublicArchive:
        members = {name: sha256(content) for name, content in FILES.items()}
        parts = {"name": "bench", "url": self.url, "page": PAGE, "members": members}
        return PublicArchive(**{**parts, **changes})

    def answer(self, handler: BaseHTTPRequestHandler) -> None:
        asked = handler.headers.get("Range")
        self.requests.append(asked)
        start = int(re.fullmatch(r"bytes=(\d+)-", asked)[1]) if asked and self.ranges else 0
        if self.status != 200:
            handler.send_error(self.status)
            return
        if start and start >= len(self.content):
            handler.send_response(416)
            handler.send_header("Content-Range", f"bytes */{len(self.content)}")
            handler.send_header("Content-Length", "0")
            handler.end_headers()
            return
        handler.send_response(302 if "Location" in self.header else 206 if start else 200)
        for name, value in self.header.items():
            handler.send_header(name, value)
        if start:
            handler.send_header("Content-Range", f"bytes {start}-{len(self.content) - 1}/{len(self.content)}")
        body = self.content[start:]
        if not self.chunked:
            handler.send_header("Content-Length", str(len(body)))
        handler.end_headers()
        handler.wfile.write(body[: self.cut_after.pop(0)] if self.cut_after else body)


@pytest.fixture
def site() -> Iterator[Site]:
    page = Site()

    class Handler(BaseHTTPRequestHandler):
        def do_GET(self) -> None:
            page.answer(self)

        def log_message(self, *_: Any) -> None:
            pass

    server = ThreadingHTTPServer(("127.0.0.1", 0), Handler)
    page.port = server.server_address[1]
    thread = threading.Thread(target=server.serve_forever, kwargs={"poll_interval": 0.01}, daemon=True)
    thread.start()
    yield page
    server.shutdown()
    server.server_close()
    thread.join()


@pytest.fixture
def pack() -> Callable[[Mapping[str, bytes]], bytes]:
    """A zip archive of some files."""
    return zipped


@pytest.fixture
def failure() -> Callable[[Callable[[], object]], str]:
    """The line with which a call is refused."""

    def said(call: Callable[[], object]) -> str:
        with pytest.raises(FetchError) as caught:
            call()
        assert "\n" not in str(caught.value)
        return str(caught.value)

    return said


@pytest.fixture
def visible() -> Callable[[Path], set[Path]]:
    """The files in a folder and below that are not hidden."""
    return lambda cache: {p for p in cache.rglob("*") if p.is_file() and not p.name.startswith(".")}


@pytest.fixture
def check_fetched(visible: Callable[[Path], set[Path]]) -> Callable[[list[Path], Path], None]:
    """Check that the members, and nothing else, lie in a folder."""

    def check(paths: list[Path], cache: Path) -> None:
        assert paths == [cache / "bench" / name for name in FILES]
        for path, content in zip(paths, FILES.values(), strict=True):
            assert path.read_bytes() == content
        assert visible(cache) == set(paths)

    return check
