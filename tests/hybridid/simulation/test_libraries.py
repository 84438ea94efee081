"""Compiled libraries outlive the process that made them."""

from __future__ import annotations

import os
import shutil
import subprocess

import pytest

from hybridid.simulation import libraries

COMPILER = shutil.which("cc")
pytestmark = pytest.mark.skipif(COMPILER is None, reason="no C compiler on this machine")


@pytest.fixture(autouse=True)
def cache(monkeypatch, tmp_path):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    libraries._folder.cache_clear()
    yield tmp_path / "hybridid" / "models"
    libraries._folder.cache_clear()


def builder(made_of: list[str]):
    def build(file):
        made_of.append(file.name)
        text = file.with_suffix(".c")
        text.write_text("int seven(void) { return 7; }\n")
        return not subprocess.run([COMPILER, "-shared", "-fPIC", str(text), "-o", str(file)]).returncode

    return build


def test_made_once_and_then_found(cache):
    made = []
    for _ in range(2):
        assert libraries.library("key", builder(made)).seven() == 7
    assert len(made) == 1
    assert [file.name for file in cache.iterdir()] == ["key.so"]


def test_what_cannot_be_loaded_is_made_anew(cache):
    made = []
    libraries._folder()
    (cache / "torn.so").write_bytes(b"half a library")
    assert libraries.library("torn", builder(made)).seven() == 7
    assert len(made) == 1


def test_a_build_that_fails_leaves_nothing(cache):
    assert libraries.library("bad", lambda file: False) is None
    assert list(cache.iterdir()) == []


def test_the_longest_unused_go_first(cache, monkeypatch):
    monkeypatch.setattr(libraries, "MOST", 10)
    libraries._folder()
    for k in range(10):
        (cache / f"old{k}.so").write_bytes(b"")
        os.utime(cache / f"old{k}.so", (k, k))
    libraries.library("new", builder([]))
    assert sorted(file.name for file in cache.iterdir()) == ["new.so", *(f"old{k}.so" for k in range(1, 10))]


def test_a_folder_of_the_process_where_the_cache_cannot_be_written(monkeypatch, tmp_path):
    blocked = tmp_path / "file"
    blocked.write_text("")
    monkeypatch.setenv("XDG_CACHE_HOME", str(blocked))
    libraries._folder.cache_clear()
    assert libraries.library("key", builder([])).seven() == 7
