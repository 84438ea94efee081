"""Public archives, against a server on this machine: resumed, checked and cached."""

from __future__ import annotations

import hashlib
import re
import socket
import threading
from pathlib import Path

import pytest

from hybridid.fetch import ARCHIVES, archive_named, fetch


def digest(content: bytes) -> str:
    return hashlib.sha256(content).hexdigest()


def test_members_arrive_and_stay(site, tmp_path, check_fetched):
    archive = site.archive(sha256=digest(site.content))
    check_fetched(fetch(archive, tmp_path), tmp_path)
    check_fetched(fetch(archive, tmp_path), tmp_path)
    assert site.requests == [None]
    assert not list((tmp_path / "bench").glob(".*part*"))


def test_a_cache_that_cannot_be_written_serves(site, tmp_path, check_fetched):
    fetch(site.archive(), tmp_path)
    (tmp_path / "bench").chmod(0o555)
    try:
        check_fetched(fetch(site.archive(), tmp_path), tmp_path)
    finally:
        (tmp_path / "bench").chmod(0o755)


def test_members_are_found_in_a_folder_of_the_archive(site, tmp_path, check_fetched, pack):
    """SilverboxFiles.zip holds SilverboxFiles/SNLS80mV.csv, and macOS adds its own."""
    deep = {f"Files/{name}": content for name, content in site.files.items()}
    site.content = pack({"__MACOSX/Files/._one.mat": b"x", "Files/readme.txt": b"y", **deep})
    check_fetched(fetch(site.archive(), tmp_path), tmp_path)


def test_progress_counts_up_to_the_whole(site, tmp_path):
    heard: list[tuple[int, int | None]] = []
    fetch(site.archive(), tmp_path, lambda done, total: heard.append((done, total)))
    done = [d for d, _ in heard]
    assert done == sorted(done)
    assert len(done) > 3
    assert done[-1] == len(site.content)
    assert {total for _, total in heard} == {len(site.content)}


def test_a_cut_connection_is_taken_up_where_it_was_cut(site, tmp_path, check_fetched):
    site.cut_after = [100_000, 60_000, 50_000]
    heard: list[int] = []
    check_fetched(fetch(site.archive(), tmp_path, lambda done, _: heard.append(done)), tmp_path)
    assert site.requests[0] is None
    starts = [int(asked[6:-1]) for asked in site.requests[1:] if asked]
    assert len(starts) == 3
    assert 0 < starts[0] <= 100_000 < starts[1] <= 160_000 < starts[2] <= 210_000
    assert heard == sorted(heard)


def test_a_download_given_up_is_resumed_by_the_next_call(site, tmp_path, check_fetched, failure, visible):
    site.cut_after = [100_000, 0, 0]
    message = failure(lambda: fetch(site.archive(), tmp_path))
    kept = int(re.search(r"(\d+) bytes are kept, fetch again to resume", message)[1])
    assert 0 < kept <= 100_000
    assert site.page in message
    assert visible(tmp_path) == set()
    site.cut_after = []
    site.requests.clear()
    check_fetched(fetch(site.archive(), tmp_path), tmp_path)
    assert site.requests == [f"bytes={kept}-"]


def test_a_server_without_ranges_sends_the_whole_again(site, tmp_path, check_fetched):
    site.ranges = False
    site.cut_after = [100_000, 150_000]
    check_fetched(fetch(site.archive(), tmp_path), tmp_path)
    assert len(site.requests) == 3


def test_a_server_that_does_not_say_how_long(site, tmp_path, check_fetched):
    site.chunked = True
    check_fetched(fetch(site.archive(), tmp_path), tmp_path)


def leave_part(cache: Path, content: bytes) -> None:
    (cache / "bench").mkdir()
    (cache / "bench/.bench.part").write_bytes(content)


def test_a_whole_download_that_was_not_unpacked_is_not_repeated(site, tmp_path, check_fetched):
    leave_part(tmp_path, site.content)
    check_fetched(fetch(site.archive(), tmp_path), tmp_path)
    assert site.requests == [f"bytes={len(site.content)}-"]


@pytest.mark.parametrize("beginning", [b"of another file", b"x" * 1_000_000])
def test_a_beginning_of_another_file_is_dropped(site, tmp_path, beginning, check_fetched):
    leave_part(tmp_path, beginning)
    check_fetched(fetch(site.archive(sha256=digest(site.content)), tmp_path), tmp_path)
    assert site.requests[-1] is None


def test_a_lost_member_is_fetched_again(site, tmp_path, check_fetched):
    paths = fetch(site.archive(), tmp_path)
    paths[1].unlink()
    check_fetched(fetch(site.archive(), tmp_path), tmp_path)


def test_no_network(site, tmp_path, failure):
    with socket.socket() as taken:  # bound but not listening: nobody answers there
        taken.bind(("127.0.0.1", 0))
        site.port = taken.getsockname()[1]
        message = failure(lambda: fetch(site.archive(), tmp_path))
    assert "there is no connection to the server" in message
    by_hand = f"download it from {site.page} by hand and put one.mat, sub/two.csv into"
    assert f"{by_hand} {tmp_path / 'bench'}" in message


def test_two_at_once_download_once(site, tmp_path, check_fetched):
    threads = [threading.Thread(target=fetch, args=(site.archive(), tmp_path)) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    check_fetched(fetch(site.archive(), tmp_path), tmp_path)
    assert site.requests == [None]


def test_a_cache_that_is_a_file(site, tmp_path, failure):
    (tmp_path / "cache").write_text("no folder")
    assert "cannot write to" in failure(lambda: fetch(site.archive(), tmp_path / "cache"))


def test_the_known_archives(failure):
    assert {archive.name for archive in ARCHIVES} == {"emps", "silverbox"}
    for archive in ARCHIVES:
        assert archive_named(archive.name) is archive
        assert archive.citation
        assert archive.licence
        assert archive.page.startswith("https://www.nonlinearbenchmark.org/")
    assert "did you mean 'silverbox'?" in failure(lambda: archive_named("silverbx"))
