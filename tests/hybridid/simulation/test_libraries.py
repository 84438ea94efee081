"""Compiled libraries outlive the process that made them, and no other user's is ever loaded."""

from __future__ import annotations

import itertools
import os
import shutil
import subprocess
import timeit
import warnings
from multiprocessing import get_context

import pytest

from hybridid import private
from hybridid.simulation import libraries

COMPILER = shutil.which("cc")
pytestmark = pytest.mark.skipif(COMPILER is None, reason="no C compiler on this machine")


@pytest.fixture(autouse=True)
def cache(monkeypatch, tmp_path):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    monkeypatch.delenv(private._WARNED, raising=False)
    for once in (private.cache_folder, private._of_this_process):
        once.cache_clear()
    yield tmp_path / "hybridid" / "models"
    for once in (private.cache_folder, private._of_this_process):
        once.cache_clear()


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
    private.cache_folder()
    (cache / "torn.so").write_bytes(b"half a library")
    assert libraries.library("torn", builder(made)).seven() == 7
    assert len(made) == 1


def test_a_build_that_fails_leaves_nothing(cache):
    assert libraries.library("bad", lambda file: False) is None
    assert list(cache.iterdir()) == []


def test_the_longest_unused_go_first(cache, monkeypatch):
    monkeypatch.setattr(libraries, "MOST", 10)
    monkeypatch.setattr(libraries, "_made", itertools.count())  # as in a process that has made none
    private.cache_folder()
    for k in range(10):
        (cache / f"old{k}.so").write_bytes(b"")
        os.utime(cache / f"old{k}.so", (k, k))
    libraries.library("new", builder([]))
    assert sorted(file.name for file in cache.iterdir()) == ["new.so", *(f"old{k}.so" for k in range(1, 10))]


def test_a_folder_of_the_process_where_the_cache_cannot_be_written(monkeypatch, tmp_path):
    blocked = tmp_path / "file"
    blocked.write_text("")
    monkeypatch.setenv("XDG_CACHE_HOME", str(blocked))
    private.cache_folder.cache_clear()
    with pytest.warns(UserWarning, match="not kept: .*file.* cannot be used"):
        assert libraries.library("key", builder([])).seven() == 7


def left_by_an_earlier_process(cache, key="key"):
    """A library of this name and the right seal, in a file that this process has not loaded."""
    private.cache_folder.cache_clear()
    libraries.library(key, builder([]))
    kept = cache / f"{key}.so"
    content = kept.read_bytes()
    kept.unlink()
    kept.write_bytes(content)
    kept.chmod(0o600)
    assert private.content_of_sealed(kept) is not None
    return kept


def foreign(file, mark):
    """A library that writes ``mark`` as soon as it is loaded."""
    text = file.with_suffix(".c")
    text.write_text(
        f"""#include <stdio.h>
        __attribute__((constructor)) static void ran(void) {{ fclose(fopen("{mark}", "w")); }}
        int seven(void) {{ return 8; }}"""
    )
    file.unlink(missing_ok=True)
    subprocess.run([COMPILER, "-shared", "-fPIC", str(text), "-o", str(file)], check=True)
    text.unlink()
    return file


@pytest.mark.parametrize("length", [0, 10, 8000, -1])
def test_a_library_that_was_cut_off_is_made_anew(cache, length):
    """Loaded, it would end the process: Bus error."""
    kept = left_by_an_earlier_process(cache)
    whole = kept.read_bytes()
    assert len(whole) > 8000
    kept.write_bytes(whole[:length])
    made = []
    assert libraries.library("key", builder(made)).seven() == 7
    assert made == ["key.so"]
    assert private.content_of_sealed(kept) is not None


def test_a_library_under_another_name_is_not_loaded(cache):
    kept = left_by_an_earlier_process(cache, "one")
    kept.rename(cache / "other.so")
    made = []
    libraries.library("other", builder(made))
    assert made == ["other.so"]


def test_a_library_without_a_seal_is_not_loaded(cache, tmp_path):
    private.cache_folder()
    foreign(cache / "key.so", tmp_path / "ran")
    assert libraries.library("key", builder([])).seven() == 7
    assert not (tmp_path / "ran").exists()


@pytest.mark.parametrize("who", ["file", "folder", "above", "link"])
@pytest.mark.skipif(os.geteuid() != 0, reason="only root can give a folder to another user")
def test_nothing_of_another_user_is_loaded(cache, tmp_path, who):
    """Not even with the right seal."""
    kept = left_by_an_earlier_process(cache)
    foreign(kept, tmp_path / "ran")
    kept.write_bytes(private.sealed(kept.name, kept.read_bytes()))
    kept.chmod(0o600)
    assert private.content_of_sealed(kept) is not None
    if who == "link":
        cache.rename(tmp_path / "theirs")
        os.chown(tmp_path / "theirs", 65534, 65534)
        cache.symlink_to(tmp_path / "theirs")
    else:
        os.chown({"file": kept, "folder": cache, "above": cache.parent}[who], 65534, 65534)
    private.cache_folder.cache_clear()
    if who == "file":
        assert libraries.library("key", builder([])).seven() == 7
    else:
        with pytest.warns(UserWarning, match="compiled models are not kept: .* belongs to "):
            assert libraries.library("key", builder([])).seven() == 7
        private.cache_folder.cache_clear()
        with warnings.catch_warnings():
            warnings.simplefilter("error")  # one warning is enough, for the processes that it starts too
            libraries.library("key", builder([]))
    assert not (tmp_path / "ran").exists()


@pytest.mark.parametrize("mode", [0o777, 0o770, 0o1777])
def test_a_folder_that_others_may_write_to_is_not_used(cache, mode):
    kept = left_by_an_earlier_process(cache)
    cache.chmod(mode)
    private.cache_folder.cache_clear()
    made = []
    with pytest.warns(UserWarning, match="others may write to .*; chmod go-w closes it"):
        libraries.library("key", builder(made))
    assert made == ["key.so"]
    assert kept.exists()
    assert private.cache_folder() != cache
    assert private.cache_folder().stat().st_mode & 0o777 == 0o700


def test_what_it_makes_is_private(cache):
    libraries.library("key", builder([]))
    assert (cache / "key.so").stat().st_mode & 0o777 == 0o600
    assert cache.stat().st_mode & 0o777 == 0o700


def test_a_check_takes_well_below_a_millisecond(cache, tmp_path):
    private.cache_folder()
    content = os.urandom(50_000)
    kept = cache / "key.so"
    kept.write_bytes(private.sealed(kept.name, content))
    kept.chmod(0o600)
    fastest = min(timeit.repeat(lambda: private.content_of_sealed(kept), number=1, repeat=50))
    assert private.content_of_sealed(kept) is not None
    assert fastest < 0.5e-3


def three_libraries():
    for k in range(3):
        assert libraries.library(f"key{k}", builder([])).seven() == 7


def test_many_processes_at_once_get_sound_libraries(cache):
    """Some find it, some make it, some replace what another made."""
    processes = [get_context("fork").Process(target=three_libraries) for _ in range(6)]
    for process in processes:
        process.start()
    for process in processes:
        process.join(60)
    assert [process.exitcode for process in processes] == [0] * 6
    kept = list(cache.iterdir())
    assert sorted(file.name for file in kept) == ["key0.so", "key1.so", "key2.so"]
    assert None not in map(private.content_of_sealed, kept)
