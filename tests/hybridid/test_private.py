"""A folder is the user's own only if nobody else can change what lies there."""

from __future__ import annotations

import os

import pytest

from hybridid import private

OTHER = 65534
needs_root = pytest.mark.skipif(os.geteuid() != 0, reason="only root can give a folder to another user")


@pytest.fixture
def inner(tmp_path):
    folder = tmp_path / "outer" / "inner"
    folder.mkdir(parents=True)
    return folder


def test_a_folder_of_ones_own_is_private(inner):
    assert private.exposed(inner) == ""


@pytest.mark.parametrize("mode", [0o720, 0o702, 0o1777])
def test_a_folder_that_others_may_write_to_is_not(inner, mode):
    inner.chmod(mode)
    assert private.exposed(inner) == f"others may write to {inner}; chmod go-w closes it"


def test_nor_one_that_others_may_replace(inner):
    inner.parent.chmod(0o777)
    assert private.exposed(inner) == f"everybody may write to {inner.parent}"
    inner.parent.chmod(0o1777)  # as /tmp: only an owner may replace what is there
    assert private.exposed(inner) == ""


@needs_root
def test_nor_one_that_belongs_to_another_user_or_lies_in_such(inner):
    os.chown(inner.parent, OTHER, OTHER)
    assert f"{inner.parent} belongs to " in private.exposed(inner)
    os.chown(inner, OTHER, OTHER)
    assert f"{inner} belongs to " in private.exposed(inner)


@needs_root
def test_a_link_is_judged_by_where_it_leads(inner, tmp_path):
    link = tmp_path / "link"
    link.symlink_to(inner)
    assert private.exposed(link) == ""
    os.chown(inner, OTHER, OTHER)
    assert "belongs to" in private.exposed(link)


def test_content_of_ones_own_file_alone_is_read(tmp_path):
    file = tmp_path / "file"
    file.write_bytes(b"content")
    file.chmod(0o644)
    assert private.content_of_own(file) == b"content"
    file.chmod(0o664)
    assert private.content_of_own(file) is None
    file.chmod(0o600)
    (tmp_path / "link").symlink_to(file)
    assert private.content_of_own(tmp_path / "link") is None
    assert private.content_of_own(tmp_path) is None
    assert private.content_of_own(tmp_path / "missing") is None
    os.mkfifo(tmp_path / "pipe")
    assert private.content_of_own(tmp_path / "pipe") is None, "it waits for nobody"


def test_numba_keeps_nothing_where_others_could_change_it(tmp_path, monkeypatch):
    """It unpickles what it finds there."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    monkeypatch.setenv("NUMBA_CACHE_DIR", "")  # so that what is set below is taken back
    monkeypatch.delenv("NUMBA_CACHE_DIR")
    monkeypatch.setattr(os, "access", lambda *given: False)  # installed where the user cannot write
    (tmp_path / "numba").mkdir(mode=0o700)
    private.keep_numba_private()
    assert "NUMBA_CACHE_DIR" not in os.environ
    (tmp_path / "numba").chmod(0o777)
    private.keep_numba_private()
    assert private.exposed(private.Path(os.environ["NUMBA_CACHE_DIR"])) == ""
