"""Public archives, against a server on this machine: resumed, checked, cached, and honest when they fail."""

from __future__ import annotations

import hashlib
import io
import re
import socket
import threading
import zipfile
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from hybridid.fetch import ARCHIVES, FetchError, PublicArchive, archive_named, download, fetch

FILES = {name: np.random.default_rng(i).bytes(150_000) for i, name in enumerate(("one.mat", "sub/two.csv"))}
PAGE = "https://example.org/benchmark"


def zipped(files: dict[str, bytes]) -> bytes:
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in files.items():
            archive.writestr(name, content)
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
    requests: list[str | None] = field(default_factory=list)  # the Range header of each

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
        handler.send_response(206 if start else 200)
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


def assert_fetched(paths: list[Path], cache: Path) -> None:
    assert paths == [cache / "bench" / name for name in FILES]
    for path, content in zip(paths, FILES.values(), strict=True):
        assert path.read_bytes() == content
    assert visible(cache) == set(paths)


def visible(cache: Path) -> set[Path]:
    return {p for p in cache.rglob("*") if p.is_file() and not p.name.startswith(".")}


def failure(call: Callable[[], object]) -> str:
    with pytest.raises(FetchError) as caught:
        call()
    assert "\n" not in str(caught.value)
    return str(caught.value)


def test_members_arrive_and_stay(site, tmp_path):
    archive = site.archive(sha256=sha256(site.content))
    assert_fetched(fetch(archive, tmp_path), tmp_path)
    assert_fetched(fetch(archive, tmp_path), tmp_path)
    assert site.requests == [None]
    assert not list((tmp_path / "bench").glob(".*part*"))


def test_a_cache_that_cannot_be_written_serves(site, tmp_path):
    fetch(site.archive(), tmp_path)
    (tmp_path / "bench").chmod(0o555)
    try:
        assert_fetched(fetch(site.archive(), tmp_path), tmp_path)
    finally:
        (tmp_path / "bench").chmod(0o755)


def test_members_are_found_in_a_folder_of_the_archive(site, tmp_path):
    """SilverboxFiles.zip holds SilverboxFiles/SNLS80mV.csv, and macOS adds its own."""
    deep = {f"Files/{name}": content for name, content in FILES.items()}
    site.content = zipped({"__MACOSX/Files/._one.mat": b"x", "Files/readme.txt": b"y", **deep})
    assert_fetched(fetch(site.archive(), tmp_path), tmp_path)


def test_progress_counts_up_to_the_whole(site, tmp_path):
    heard: list[tuple[int, int | None]] = []
    fetch(site.archive(), tmp_path, lambda done, total: heard.append((done, total)))
    done = [d for d, _ in heard]
    assert done == sorted(done)
    assert len(done) > 3
    assert done[-1] == len(site.content)
    assert {total for _, total in heard} == {len(site.content)}


def test_a_cut_connection_is_taken_up_where_it_was_cut(site, tmp_path):
    site.cut_after = [100_000, 60_000, 50_000]
    heard: list[int] = []
    assert_fetched(fetch(site.archive(), tmp_path, lambda done, _: heard.append(done)), tmp_path)
    assert site.requests[0] is None
    starts = [int(asked[6:-1]) for asked in site.requests[1:] if asked]
    assert len(starts) == 3
    assert 0 < starts[0] <= 100_000 < starts[1] <= 160_000 < starts[2] <= 210_000
    assert heard == sorted(heard)


def test_a_download_given_up_is_resumed_by_the_next_call(site, tmp_path):
    site.cut_after = [100_000, 0, 0]
    message = failure(lambda: fetch(site.archive(), tmp_path))
    kept = int(re.search(r"(\d+) bytes are kept, fetch again to resume", message)[1])
    assert 0 < kept <= 100_000
    assert PAGE in message
    assert visible(tmp_path) == set()
    site.cut_after = []
    site.requests.clear()
    assert_fetched(fetch(site.archive(), tmp_path), tmp_path)
    assert site.requests == [f"bytes={kept}-"]


def test_a_server_without_ranges_sends_the_whole_again(site, tmp_path):
    site.ranges = False
    site.cut_after = [100_000, 150_000]
    assert_fetched(fetch(site.archive(), tmp_path), tmp_path)
    assert len(site.requests) == 3


def test_a_server_that_does_not_say_how_long(site, tmp_path):
    site.chunked = True
    assert_fetched(fetch(site.archive(), tmp_path), tmp_path)


def leave_part(cache: Path, content: bytes) -> None:
    (cache / "bench").mkdir()
    (cache / "bench/.bench.part").write_bytes(content)


def test_a_whole_download_that_was_not_unpacked_is_not_repeated(site, tmp_path):
    leave_part(tmp_path, site.content)
    assert_fetched(fetch(site.archive(), tmp_path), tmp_path)
    assert site.requests == [f"bytes={len(site.content)}-"]


@pytest.mark.parametrize("beginning", [b"of another file", b"x" * 1_000_000])
def test_a_beginning_of_another_file_is_dropped(site, tmp_path, beginning):
    leave_part(tmp_path, beginning)
    assert_fetched(fetch(site.archive(sha256=sha256(site.content)), tmp_path), tmp_path)
    assert site.requests[-1] is None


@pytest.mark.parametrize("which", ["archive", "member"])
def test_a_wrong_hash_deletes_and_says_so(site, tmp_path, which):
    wrong = sha256(b"other")
    members = {**site.archive().members, "sub/two.csv": wrong}
    archive = site.archive(sha256=wrong) if which == "archive" else site.archive(members=members)
    message = failure(lambda: fetch(archive, tmp_path))
    assert ("the archive" if which == "archive" else "sub/two.csv") in message
    assert f"published is {wrong[:12]}" in message
    assert "deleted" in message
    assert PAGE in message
    assert [p for p in tmp_path.rglob("*") if p.is_file() and p.name != ".lock"] == []


def test_a_file_that_is_not_the_published_one_is_never_replaced(site, tmp_path):
    (tmp_path / "bench").mkdir()
    own = tmp_path / "bench/one.mat"
    own.write_bytes(b"measured with great pains")
    message = failure(lambda: fetch(site.archive(), tmp_path))
    assert str(own) in message
    assert "move it away" in message
    assert own.read_bytes() == b"measured with great pains"
    assert site.requests == []


def test_a_lost_member_is_fetched_again(site, tmp_path):
    paths = fetch(site.archive(), tmp_path)
    paths[1].unlink()
    assert_fetched(fetch(site.archive(), tmp_path), tmp_path)


@pytest.mark.parametrize(
    "entry",
    [
        "../escaped.mat",
        "../../bench2/one.mat",
        "/tmp/escaped.mat",
        "Files/../../escaped.mat",
        "..\\escaped.mat",
        "C:\\x",
    ],
)
def test_an_archive_that_reaches_out_of_its_folder_is_refused(site, tmp_path, entry):
    site.content = zipped({**FILES, entry: b"evil"})
    cache = tmp_path / "deep/cache"
    message = failure(lambda: fetch(site.archive(), cache))
    assert "a path that leaves its folder" in message
    assert visible(tmp_path) == set()


@pytest.mark.parametrize("member", ["../one.mat", "/etc/passwd", "a/../../b", "", "a\\b"])
def test_a_declared_member_cannot_reach_out_either(site, member):
    assert "no path inside a folder" in failure(lambda: site.archive(members={member: sha256(b"")}))


def test_a_web_page_instead_of_the_archive(site, tmp_path):
    site.content = b"<!DOCTYPE html><html><title>Quota exceeded</title></html>"
    message = failure(lambda: fetch(site.archive(), tmp_path))
    assert "sent no zip archive but a web page" in message
    assert PAGE in message


@pytest.mark.parametrize("damage", ["truncated", "flipped", "member missing"])
def test_a_damaged_archive(site, tmp_path, damage):
    whole = site.content
    flipped = bytearray(whole)
    flipped[len(whole) // 4] ^= 0xFF
    site.content = {
        "truncated": whole[: len(whole) // 2],
        "flipped": bytes(flipped),
        "member missing": zipped({"one.mat": FILES["one.mat"]}),
    }[damage]
    message = failure(lambda: fetch(site.archive(), tmp_path))
    assert PAGE in message
    assert visible(tmp_path) == set()
    assert ("holds no sub/two.csv; it holds one.mat" in message) == (damage == "member missing")


def test_a_server_that_sends_without_end_is_left(site, tmp_path):
    site.content, site.chunked = b"PK" + bytes(10**6), True
    message = failure(lambda: fetch(site.archive(most=100_000), tmp_path))
    assert "the server sends more than 0.1 MB" in message
    assert list((tmp_path / "bench").glob("*.part")) == []


def test_a_file_that_the_server_says_is_too_large_is_not_loaded(site, tmp_path):
    site.content = bytes(10**6)
    seen: list[int] = []
    failure(lambda: fetch(site.archive(most=100_000), tmp_path, lambda done, _: seen.append(done)))
    assert seen == []


def test_a_server_that_dribbles_is_left_and_taken_up_later(site, tmp_path, monkeypatch):
    monkeypatch.setattr(download, "LONGEST", -1.0)
    assert "it took longer than" in failure(lambda: fetch(site.archive(), tmp_path))
    monkeypatch.undo()
    assert_fetched(fetch(site.archive(), tmp_path), tmp_path)


def test_a_small_archive_that_unpacks_to_much(site, tmp_path):
    bomb = zipped({**FILES, next(iter(FILES)): bytes(10**7)})
    site.content = bomb
    message = failure(lambda: fetch(site.archive(most=10**6), tmp_path))
    assert "unpacks to more than 1 MB" in message
    assert visible(tmp_path) == set()


def test_no_network(tmp_path):
    with socket.socket() as taken:  # bound but not listening: nobody answers there
        taken.bind(("127.0.0.1", 0))
        archive = Site(port=taken.getsockname()[1]).archive()
        message = failure(lambda: fetch(archive, tmp_path))
    assert "there is no connection to the server" in message
    assert (
        f"download it from {PAGE} by hand and put one.mat, sub/two.csv into {tmp_path / 'bench'}" in message
    )


def test_a_refusal(site, tmp_path):
    site.status = 404
    message = failure(lambda: fetch(site.archive(), tmp_path))
    assert "the server answered 404 Not Found" in message
    assert PAGE in message


def test_two_at_once_download_once(site, tmp_path):
    threads = [threading.Thread(target=fetch, args=(site.archive(), tmp_path)) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert_fetched(fetch(site.archive(), tmp_path), tmp_path)
    assert site.requests == [None]


def test_a_cache_that_is_a_file(site, tmp_path):
    (tmp_path / "cache").write_text("no folder")
    assert "cannot write to" in failure(lambda: fetch(site.archive(), tmp_path / "cache"))


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"url": "ftp://example.org/x.zip"}, "is no http or https address"),
        ({"sha256": "abc"}, "'abc' is no SHA-256"),
        ({"members": {"one.mat": "XYZ"}}, "'XYZ' is no SHA-256"),
    ],
)
def test_a_declaration_that_cannot_be(site, changes, said):
    assert said in failure(lambda: site.archive(**changes))


def test_the_known_archives():
    assert {archive.name for archive in ARCHIVES} == {"emps", "silverbox"}
    for archive in ARCHIVES:
        assert archive_named(archive.name) is archive
        assert archive.citation
        assert archive.licence
        assert archive.page.startswith("https://www.nonlinearbenchmark.org/")
    assert "did you mean 'silverbox'?" in failure(lambda: archive_named("silverbx"))
