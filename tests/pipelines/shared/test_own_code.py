"""The user's own Python files: no library gives way to them, and what runs is what one reads."""

from __future__ import annotations

import importlib
import os
import py_compile
import subprocess
import sys
from pathlib import Path

import pytest

from pipelines.shared import own_code
from pipelines.shared.errors import ConfigError
from pipelines.shared.imports import named
from pipelines.shared.own_code import code_in, digest_of_code, folder_with, make_importable
from pipelines.shared.pool import side_by_side

ROOT = Path(__file__).parents[3]
pytestmark = pytest.mark.usefixtures("nothing_imported")


@pytest.fixture
def lab(own_folder):
    folder = own_folder / "lab"
    (folder / "case").mkdir(parents=True)
    return folder


def test_a_library_never_gives_way(lab):
    """Not one that is still to be imported, either."""
    for name in ("colorsys", "matplotlib", "json"):
        (lab / f"{name}.py").write_text("OWN = 1")
    sys.modules.pop("colorsys", None)
    make_importable([lab])
    for name in ("colorsys", "matplotlib", "json"):
        assert not hasattr(importlib.import_module(name), "OWN")
        with pytest.raises(ConfigError, match=f"plant {name}:OWN: {name} is already the name of .*{name}"):
            named(f"{name}:OWN", "plant")


def test_own_files_are_found_beside_the_case_files_and_above(lab):
    (lab / "case" / "beside_of_test.py").write_text("NAME = 1")
    (lab / "above_of_test.py").write_text("from package_of_test.part import NAME")
    (lab / "package_of_test").mkdir()
    (lab / "package_of_test" / "part.py").write_text("NAME = 2")
    make_importable([lab])
    assert named("beside_of_test:NAME", "plant") == 1
    assert named("above_of_test:NAME", "plant") == 2
    assert folder_with("package_of_test.part", [lab]) == lab
    assert folder_with("nothing_of_test", [lab]) is None


def test_two_folders_with_a_module_of_one_name(lab, own_folder):
    other = own_folder / "other"
    other.mkdir()
    for number, folder in enumerate((lab, other)):
        (folder / "twin_of_test.py").write_text(f"NUMBER = {number}")
    make_importable([lab, other])
    assert named("twin_of_test:NUMBER", "plant") == 0
    with pytest.raises(ConfigError, match=r"already the name of .*/lab/twin_of_test\.py"):
        own_code.check_comes_from(other, "twin_of_test", "plant")


def poisoned(folder: Path, name: str) -> Path:
    """A harmless module with bytecode of another source, which Python would take for its own."""
    source = folder / f"{name}.py"
    source.write_text("SAID = 'evil'")
    cached = py_compile.compile(str(source), invalidation_mode=py_compile.PycInvalidationMode.UNCHECKED_HASH)
    source.write_text("SAID = 'good'")
    return Path(str(cached))


def test_bytecode_beside_the_source_does_not_run(lab):
    poisoned(lab, "read_of_test")
    (lab / "folder_of_test").mkdir()
    poisoned(lab / "folder_of_test", "__init__")
    poisoned(lab / "folder_of_test", "part")
    make_importable([lab])
    for name in ("read_of_test", "folder_of_test", "folder_of_test.part"):
        assert importlib.import_module(name).SAID == "good", name


def test_no_bytecode_is_written(lab):
    (lab / "written_here.py").write_text("X = 1")
    make_importable([lab])
    importlib.import_module("written_here")
    assert not (lab / "__pycache__").exists()


def said(name, watcher):
    return importlib.import_module(name).SAID


def test_processes_of_the_pool_import_the_same(lab):
    poisoned(lab, "read_of_test")
    make_importable([lab])
    assert dict(side_by_side(said, {"one": "read_of_test"}, 1)) == {"one": "good"}


def test_an_environment_below_is_none_of_it(lab, monkeypatch):
    """``--config-dir .`` beside a ``.venv``: the libraries there keep their bytecode."""
    libraries = lab / "venv" / "lib" / "site-packages"
    libraries.mkdir(parents=True)
    monkeypatch.setattr(sys, "path", [*sys.path, str(libraries)])
    make_importable([lab])
    assert own_code._is_own(str(lab))
    assert own_code._is_own(str(lab / "package"))
    assert not own_code._is_own(str(libraries))
    assert not own_code._is_own(str(libraries / "numpy"))


def test_the_digest_is_of_all_that_an_import_could_run(lab, own_folder):
    (lab / "one.py").write_text("1")
    elsewhere = own_folder / "elsewhere"
    elsewhere.mkdir()
    (lab / "linked").symlink_to(elsewhere)
    digests = [digest_of_code(lab)]
    for path, text in (
        (lab / "one.py", "2"),
        (lab / "two.py", ""),
        (lab / "case" / "three.py", ""),
        (lab / "package" / "below" / "four.py", ""),
        (lab / f"five{own_code.EXTENSION_SUFFIXES[0]}", ""),
        (elsewhere / "six.py", ""),
    ):
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
        digests.append(digest_of_code(lab))
    (lab / "two.py").rename(lab / "seven.py")
    digests.append(digest_of_code(lab))
    assert len(set(digests)) == len(digests)


def test_the_digest_is_of_nothing_else(lab, own_folder):
    (lab / "one.py").write_text("1")
    before = digest_of_code(lab)
    for name in ("notes.md", "record.csv", ".git/hook.py", "__pycache__/one.cpython-311.pyc"):
        (lab / name).parent.mkdir(exist_ok=True)
        (lab / name).write_text("anything")
    os.mkfifo(lab / "pipe.py")
    assert digest_of_code(lab) == before
    lab.rename(own_folder / "moved")
    assert digest_of_code(own_folder / "moved") == before


def test_links_that_lead_round_come_to_an_end(lab):
    (lab / "one.py").write_text("1")
    (lab / "round").symlink_to(lab)
    assert code_in(lab) == [lab / "one.py", lab / "round" / "one.py"]


def test_a_folder_with_too_much_code_is_refused(lab, monkeypatch):
    monkeypatch.setattr(own_code, "MOST_FILES", 3)
    for number in range(4):
        (lab / f"file{number}.py").write_text("")
    with pytest.raises(ConfigError, match="lab holds more than 3 folders or files of code"):
        code_in(lab)


def test_no_process_finds_modules_in_the_folder_one_stands_in(own_folder):
    """It may be a received one; the processes of a pool once ran its ``socket.py``."""
    (own_folder / "socket.py").write_text("open('ran', 'w')")
    code = (
        "import sys; sys.path.remove('')\n"  # as it is for the installed command
        "import hybridid_cli.main as main; main.dispatch = lambda words: pool()\n"
        "from pipelines.shared.pool import side_by_side\n"
        "def pool():\n"
        "    print([type(found).__name__ for _, found in side_by_side(print, {'a': 1}, 1)])\n"
        "    return 0\n"
        "main.main()\n"
    )
    environment = {k: v for k, v in os.environ.items() if k != "PYTHONSAFEPATH"} | {"PYTHONPATH": str(ROOT)}
    done = subprocess.run(
        [sys.executable, "-c", code], env=environment, capture_output=True, text=True, timeout=60
    )
    assert "NoneType" in done.stdout, done.stderr
    assert not (own_folder / "ran").exists()
