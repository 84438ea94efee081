"""``hybridid fetch`` against a server on this machine, and with no server at all."""

from __future__ import annotations

import functools
import hashlib
import io
import threading
import zipfile
from dataclasses import replace
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path

import pytest

from hybridid.fetch import library

MEMBERS = {"DATA_EMPS.mat": b"first record", "DATA_EMPS_PULSES.mat": b"second record"}


@pytest.fixture
def archive() -> bytes:
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w") as packed:
        for name, content in MEMBERS.items():
            packed.writestr(f"EMPS/{name}", content)
    return buffer.getvalue()


@pytest.fixture
def address(tmp_path_factory, archive):
    """Where a local server hands the archive out."""
    folder = tmp_path_factory.mktemp("server")
    (folder / "EMPS.zip").write_bytes(archive)

    class Quiet(SimpleHTTPRequestHandler):
        def log_message(self, *words: object) -> None:
            pass

    server = ThreadingHTTPServer(("127.0.0.1", 0), functools.partial(Quiet, directory=folder))
    threading.Thread(target=server.serve_forever, daemon=True).start()
    yield f"http://127.0.0.1:{server.server_port}/EMPS.zip"
    server.shutdown()


@pytest.fixture
def published(monkeypatch):
    """The library's archive, as if these members were the published ones."""
    digests = {name: hashlib.sha256(content).hexdigest() for name, content in MEMBERS.items()}
    known = tuple(replace(a, members=digests) if a.name == "emps" else a for a in library.ARCHIVES)
    monkeypatch.setattr(library, "ARCHIVES", known)


def test_fetch_puts_the_records_where_they_are_looked_for(say, address, published):
    said = say("fetch", "emps", f"archive.url={address}")
    assert said.code == 0, said.err
    paths = [Path(line) for line in said.out.splitlines()]
    assert paths == [Path("data/raw/emps") / name for name in MEMBERS]
    assert [path.read_bytes() for path in paths] == list(MEMBERS.values())
    assert "please cite" in said.err
    assert "measured, data/raw/emps/DATA_EMPS.mat" in say("cases", "emps").out
    assert say("fetch", "emps", "archive.url=http://127.0.0.1:9/gone.zip").code == 0, "they are there already"


def test_fetch_to_another_folder(say, address, published):
    Path("mine").mkdir()
    assert say("fetch", "emps", f"archive.url={address}", "paths.data=mine").code == 0
    assert Path("mine/emps/DATA_EMPS.mat").exists()


def test_wrong_bytes_are_not_kept(say, address):
    said = say("fetch", "emps", f"archive.url={address}")
    assert said.code == 1
    assert "nonlinearbenchmark.org" in said.complaint
    assert not list(Path().rglob("*.mat"))


def test_no_network_names_the_page_to_visit(say):
    said = say("fetch", "emps", "archive.url=http://127.0.0.1:9/EMPS.zip")
    assert said.code == 1
    assert "https://www.nonlinearbenchmark.org/benchmarks/emps" in said.complaint
    assert "Traceback" not in said.err


def test_misspelt_case(say):
    said = say("fetch", "emp")
    assert said.code == 2
    assert "did you mean 'emps'?" in said.complaint
