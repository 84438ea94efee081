"""Archives and servers that are not what they say: refused in one line, and nothing is left."""

from __future__ import annotations

import hashlib

import pytest

from hybridid.fetch import download, fetch


def digest(content: bytes) -> str:
    return hashlib.sha256(content).hexdigest()


@pytest.mark.parametrize("which", ["archive", "member"])
def test_a_wrong_hash_deletes_and_says_so(site, tmp_path, which, failure):
    wrong = digest(b"other")
    members = {**site.archive().members, "sub/two.csv": wrong}
    archive = site.archive(sha256=wrong) if which == "archive" else site.archive(members=members)
    message = failure(lambda: fetch(archive, tmp_path))
    assert ("the archive" if which == "archive" else "sub/two.csv") in message
    assert f"published is {wrong[:12]}" in message
    assert "deleted" in message
    assert site.page in message
    assert [p for p in tmp_path.rglob("*") if p.is_file() and p.name != ".lock"] == []


def test_a_file_that_is_not_the_published_one_is_never_replaced(site, tmp_path, failure):
    (tmp_path / "bench").mkdir()
    own = tmp_path / "bench/one.mat"
    own.write_bytes(b"measured with great pains")
    message = failure(lambda: fetch(site.archive(), tmp_path))
    assert str(own) in message
    assert "move it away" in message
    assert own.read_bytes() == b"measured with great pains"
    assert site.requests == []


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
def test_an_archive_that_reaches_out_of_its_folder_is_refused(site, tmp_path, entry, failure, visible, pack):
    site.content = pack({**site.files, entry: b"evil"})
    cache = tmp_path / "deep/cache"
    message = failure(lambda: fetch(site.archive(), cache))
    assert "a path that leaves its folder" in message
    assert visible(tmp_path) == set()


@pytest.mark.parametrize("member", ["../one.mat", "/etc/passwd", "a/../../b", "", "a\\b"])
def test_a_declared_member_cannot_reach_out_either(site, member, failure):
    assert "no path inside a folder" in failure(lambda: site.archive(members={member: digest(b"")}))


def test_a_web_page_instead_of_the_archive(site, tmp_path, failure):
    site.content = b"<!DOCTYPE html><html><title>Quota exceeded</title></html>"
    message = failure(lambda: fetch(site.archive(), tmp_path))
    assert "sent no zip archive but a web page" in message
    assert site.page in message


@pytest.mark.parametrize("damage", ["truncated", "flipped", "member missing"])
def test_a_damaged_archive(site, tmp_path, damage, failure, visible, pack):
    whole = site.content
    flipped = bytearray(whole)
    flipped[len(whole) // 4] ^= 0xFF
    site.content = {
        "truncated": whole[: len(whole) // 2],
        "flipped": bytes(flipped),
        "member missing": pack({"one.mat": site.files["one.mat"]}),
    }[damage]
    message = failure(lambda: fetch(site.archive(), tmp_path))
    assert site.page in message
    assert visible(tmp_path) == set()
    assert ("holds no sub/two.csv; it holds one.mat" in message) == (damage == "member missing")


def test_a_server_that_sends_without_end_is_left(site, tmp_path, failure):
    site.content, site.chunked = b"PK" + bytes(10**6), True
    message = failure(lambda: fetch(site.archive(most=100_000), tmp_path))
    assert "the server sends more than 0.1 MB" in message
    assert list((tmp_path / "bench").glob("*.part")) == []


def test_a_file_that_the_server_says_is_too_large_is_not_loaded(site, tmp_path, failure):
    site.content = bytes(10**6)
    seen: list[int] = []
    failure(lambda: fetch(site.archive(most=100_000), tmp_path, lambda done, _: seen.append(done)))
    assert seen == []


def test_a_server_that_dribbles_is_left_and_taken_up_later(
    site, tmp_path, monkeypatch, check_fetched, failure
):
    monkeypatch.setattr(download, "LONGEST", -1.0)
    assert "it took longer than" in failure(lambda: fetch(site.archive(), tmp_path))
    monkeypatch.undo()
    check_fetched(fetch(site.archive(), tmp_path), tmp_path)


def test_a_small_archive_that_unpacks_to_much(site, tmp_path, failure, visible, pack):
    bomb = pack({**site.files, next(iter(site.files)): bytes(10**7)})
    site.content = bomb
    message = failure(lambda: fetch(site.archive(most=10**6), tmp_path))
    assert "unpacks to more than 1 MB" in message
    assert visible(tmp_path) == set()


def test_a_refusal(site, tmp_path, failure):
    site.status = 404
    message = failure(lambda: fetch(site.archive(), tmp_path))
    assert "the server answered 404 Not Found" in message
    assert site.page in message


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"url": "ftp://example.org/x.zip"}, "is no http or https address"),
        ({"url": "http://[::1"}, "is no http or https address"),
        ({"url": "https://"}, "is no http or https address"),
        ({"sha256": "abc"}, "'abc' is no SHA-256"),
        ({"members": {"one.mat": "XYZ"}}, "'XYZ' is no SHA-256"),
    ],
)
def test_a_declaration_that_cannot_be(site, changes, said, failure):
    assert said in failure(lambda: site.archive(**changes))


def test_a_member_without_a_name(site, tmp_path, pack, failure):
    """``zipfile`` raises an IndexError for it."""
    site.content = pack({**site.files, "": b"evil"})
    assert "the zip archive is broken" in failure(lambda: fetch(site.archive(), tmp_path))
    assert list((tmp_path / "bench").glob("*.part")) == []


def test_a_reply_that_is_not_compressed_as_it_says(site, tmp_path, failure):
    site.header = {"Content-Encoding": "gzip"}
    message = failure(lambda: fetch(site.archive(), tmp_path))
    assert "from 127.0.0.1: the reply is not compressed in the way that the server says; download" in message
    assert [p for p in (tmp_path / "bench").iterdir() if p.name != ".lock"] == []


def test_a_server_that_leads_to_no_address(site, tmp_path, failure):
    site.header = {"Location": "http://[::1"}
    message = failure(lambda: fetch(site.archive(), tmp_path))
    assert "from 127.0.0.1: the server leads to an address that is none: Invalid IPv6 URL" in message
