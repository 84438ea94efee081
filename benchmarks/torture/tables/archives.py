"""Archives that are not the published one, and servers that misbehave."""

from __future__ import annotations

import io
import itertools
import stat
import warnings
import zipfile
from collections.abc import Callable, Iterator, Mapping
from http.server import BaseHTTPRequestHandler

from benchmarks.torture.mirror import Answer, contents, zipped

MOST = 3_000_000
"""Bytes that the archive may have here: the made one has a third."""
Archive = Callable[[str], bytes]
"""An archive, given the path of a file outside that it may try to write."""


def _with(name: str) -> Archive:
    """The members, and one of another name."""
    return lambda outside: zipped({**contents(), name.replace("{outside}", outside): b"evil"})


def _link(outside: str) -> bytes:
    """A link that leads out, and a member behind it."""
    held = io.BytesIO()
    with zipfile.ZipFile(held, "w") as archive:
        link = zipfile.ZipInfo("DATA_EMPS.mat")
        link.external_attr = (stat.S_IFLNK | 0o777) << 16
        archive.writestr(link, outside)
        archive.writestr("DATA_EMPS.mat/evil", b"evil")
        for name, content in contents().items():
            archive.writestr(f"sub/{name}", content)
    return held.getvalue()


def _twice(outside: str) -> bytes:
    """A member twice: the published one, then another."""
    held = io.BytesIO()
    with zipfile.ZipFile(held, "w") as archive, warnings.catch_warnings(action="ignore"):
        for name, content in (*contents().items(), ("DATA_EMPS.mat", b"evil")):
            archive.writestr(zipfile.ZipInfo(name), content)
    return held.getvalue()


def _changed(place: int, change: Callable[[int], int]) -> bytes:
    """Each member with another byte at this ``place`` of its header, which the archive's list repeats."""
    content = bytearray(zipped(contents()))
    for mark, first in ((b"PK\x03\x04", place), (b"PK\x01\x02", place + 2)):
        for at in _places(bytes(content), mark):
            content[at + first] = change(content[at + first])
    return bytes(content)


def _places(content: bytes, mark: bytes) -> Iterator[int]:
    at = content.find(mark)
    while at >= 0:
        yield at
        at = content.find(mark, at + 1)


def _damaged(outside: str) -> bytes:
    content = bytearray(zipped(contents()))
    content[len(content) // 3] ^= 0xFF
    return bytes(content)


ARCHIVES: Mapping[str, Archive] = {
    **{
        f"a member {name}": _with(name)
        for name in (
            "../evil", "../../evil", "a/../../../evil", "{outside}", "..\\evil", "C:\\evil",
            "a\\..\\..\\evil", "./../evil", "",
        )
    },
    "a member that is a link": _link,
    "a member twice": _twice,
    "a bomb of 1 GB": lambda outside: zipped({**contents(), "DATA_EMPS.mat": bytes(1_000_000_000)}),
    "members that are locked": lambda outside: _changed(6, lambda flags: flags | 0x1),
    "an unknown compression": lambda outside: _changed(8, lambda method: 99),
    "a byte that is wrong": _damaged,
    "half of it": lambda outside: zipped(contents())[: len(zipped(contents())) // 2],
    "a member that is missing": lambda outside: zipped(dict([*contents().items()][:1])),
    "members of another content": lambda outside: zipped(dict.fromkeys(contents(), b"evil")),
    "no member": lambda outside: zipped({}),
    "a web page": lambda outside: b"<!DOCTYPE html><title>Quota exceeded</title>",
    "nothing": lambda outside: b"",
    "a pickle": lambda outside: b"cposix\nsystem\n(S'true'\ntR.",
}  # fmt: skip


def _headed(request: BaseHTTPRequestHandler, status: int = 200, **headers: object) -> None:
    request.send_response(status)
    for name, value in headers.items():
        request.send_header(name.replace("_", "-"), str(value))
    request.end_headers()


def _endless(request: BaseHTTPRequestHandler, archive: bytes) -> None:
    _headed(request)
    for _ in itertools.count():
        request.wfile.write(bytes(65536))


def _endless_header(request: BaseHTTPRequestHandler, archive: bytes) -> None:
    request.wfile.write(b"HTTP/1.0 200 OK\r\n")
    for k in itertools.count():
        request.wfile.write(f"X-{k}: {'x' * 1000}\r\n".encode())


def _reply(
    body: Callable[[bytes], bytes], length: Callable[[bytes], int] = len, status: int = 200, **headers: object
) -> Answer:
    """A body that is made of the archive, after the length that is told of it: that of the archive."""

    def answer(request: BaseHTTPRequestHandler, archive: bytes) -> None:
        _headed(request, status, **headers, Content_Length=length(archive))
        request.wfile.write(body(archive))

    return answer


def _elsewhere(address: str) -> Answer:
    return lambda request, archive: _headed(request, 302, Location=address, Content_Length=0)


def _refused(status: int) -> Answer:
    return lambda request, archive: request.send_error(status)


SERVERS: Mapping[str, Answer] = {
    "an endless reply": _endless,
    "an endless header": _endless_header,
    "a reply of 10^15 bytes": _reply(bytes, lambda archive: 10**15),
    "a reply that is shorter than it says": _reply(lambda archive: archive[:1000]),
    "a length of -1": _reply(lambda archive: b"x", lambda archive: -1),
    "a part that was not asked for": _reply(
        lambda archive: archive[500:1000], lambda archive: 500, 206, Content_Range="bytes 500-999/1000"
    ),
    "a reply that is not packed as it says": _reply(bytes, Content_Encoding="gzip"),
    "a way to a file of this machine": _elsewhere("file:///etc/passwd"),
    "a way round and round": _elsewhere("/emps.zip"),
    "a way to nowhere": _elsewhere("http://127.0.0.1:9/x"),
    "a way that is none": _elsewhere("http://[::1"),
    "404": _refused(404),
    "503": _refused(503),
    "no HTTP": lambda request, archive: request.wfile.write(bytes(range(256)) * 10),
    "no reply": lambda request, archive: None,
}
