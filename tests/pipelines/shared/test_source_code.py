"""The code behind a result is found from the imports: what it runs counts, what it does not run does not."""

from __future__ import annotations

import ast
import shutil
from pathlib import Path

import pytest

from pipelines.runner import STAGES
from pipelines.shared.source_code import PROJECT, code_of, digest, files_of, imported, with_imports

ROOT = Path(PROJECT)
SOURCES = [path for package in ("hybridid", "pipelines") for path in (ROOT / package).rglob("*.py")]

RUN = "import pipelines.shared.tree\ndef run():\n    from hybridid.simulation import machine_code"
SMALL = {
    "hybridid/__init__.py": "",
    "hybridid/simulation/__init__.py": "from hybridid.simulation.simulate import simulate",
    "hybridid/simulation/simulate.py": "import casadi as ca",
    "hybridid/simulation/machine_code.py": "SOURCE = 'shoot.c'",
    "hybridid/simulation/shoot.c": "int n;",
    "hybridid/simulation/notes.txt": "named nowhere",
    "hybridid/plotting/style.py": "import matplotlib",
    "hybridid/plants/emps.py": "from hybridid.declarations import (\n    Port,  # a place\n    State,\n)",
    "hybridid/declarations.py": "import math",
    "pipelines/shared/tree.py": "import numpy as np",
    "pipelines/shared/page.py": "TEMPLATE = 'page.html'",
    "pipelines/shared/templates/page.html": "<p>",
    "pipelines/report.py": "from pipelines.shared.page import Page",
    "pipelines/fit.py": RUN,
    "pipelines/residual/stage.py": "import torch",
    "pipelines/residual/narx.py": "from hybridid.simulation.simulate import simulate",
}


def tree(root: Path, **changes: str) -> str:
    """The small project below ``root``."""
    for name, text in {**SMALL, **changes}.items():
        (root / name).parent.mkdir(parents=True, exist_ok=True)
        (root / name).write_text(text)
    return str(root)


def test_code_is_what_a_module_runs(tmp_path):
    assert files_of("pipelines.fit", tree(tmp_path)) == [
        "hybridid/__init__.py",
        "hybridid/simulation/__init__.py",
        "hybridid/simulation/machine_code.py",
        "hybridid/simulation/shoot.c",
        "hybridid/simulation/simulate.py",
        "pipelines/fit.py",
        "pipelines/shared/tree.py",
    ]


def test_a_file_in_a_folder_below_counts_where_it_is_named(tmp_path):
    files = files_of("pipelines.report", tree(tmp_path))
    assert files == [
        "pipelines/report.py",
        "pipelines/shared/page.py",
        "pipelines/shared/templates/page.html",
    ]


def test_a_room_stands_for_all_its_modules(tmp_path):
    files = files_of("pipelines.residual", tree(tmp_path))
    assert {"pipelines/residual/stage.py", "pipelines/residual/narx.py"} < set(files)
    assert "hybridid/simulation/simulate.py" in files


def test_a_module_that_is_not_there_is_no_code(tmp_path):
    with pytest.raises(ValueError, match=r"pipelines\.attic: no such module"):
        files_of("pipelines.attic", tree(tmp_path))


def test_only_the_libraries_that_the_code_imports_count(tmp_path):
    root = tree(tmp_path)
    assert {name for name in code_of("pipelines.fit", root) if "." not in name} == {"casadi", "numpy"}
    assert {name for name in code_of("pipelines.residual", root) if "." not in name} == {"casadi", "torch"}


@pytest.mark.parametrize(
    ("changed", "room"),
    [
        ("hybridid/simulation/shoot.c", "hybridid.simulation"),
        ("hybridid/simulation/__init__.py", "hybridid.simulation"),
        ("pipelines/shared/tree.py", "pipelines.shared"),
        ("pipelines/fit.py", "pipelines.fit"),
        ("pipelines/shared/page.py", None),
        ("hybridid/plotting/style.py", None),
        ("hybridid/simulation/notes.txt", None),
        ("hybridid/plants/emps.py", None),
    ],
)
def test_a_changed_file_changes_the_digest_of_its_room(tmp_path, changed, room):
    before = code_of("pipelines.fit", tree(tmp_path / "before"))
    after = code_of("pipelines.fit", tree(tmp_path / "after", **{changed: SMALL[changed] + "\n# other"}))
    assert {name for name in before if before[name] != after[name]} == ({room} if room else set())


def test_users_code_brings_what_it_imports_and_the_data_that_it_names(tmp_path):
    root = tree(tmp_path / "project")
    own = tmp_path / "own"
    own.mkdir()
    (own / "cable.py").write_text("from hybridid.plants import emps\nTABLE = 'stretch.csv'\n")
    (own / "stretch.csv").write_text("1,2")
    (own / "other.csv").write_text("1,2")
    assert with_imports([str(own / "cable.py")], root) == [
        str(own / "cable.py"),
        str(own / "stretch.csv"),
        "hybridid/__init__.py",
        "hybridid/declarations.py",
        "hybridid/plants/emps.py",
    ]


def test_of_the_files_beside_users_code_those_count_that_it_names(tmp_path):
    (tmp_path / "cable.py").write_text("from springs import stiffness\n")
    (tmp_path / "springs.py").write_text("import importlib\nimportlib.import_module('wire')\n")
    (tmp_path / "wire.py").write_text("")
    (tmp_path / "notes.py").write_text("import cable\n")
    found = with_imports([str(tmp_path / "cable.py")])
    assert found == [str(tmp_path / name) for name in ("cable.py", "springs.py", "wire.py")]


def test_the_same_code_in_another_folder_has_the_same_digest(tmp_path):
    for folder in ("one", "two"):
        (tmp_path / folder).mkdir()
        (tmp_path / folder / "cable.py").write_text("import math\n")
    assert digest([str(tmp_path / "one" / "cable.py")]) == digest([str(tmp_path / "two" / "cable.py")])


@pytest.mark.parametrize(
    ("changed", "stale"),
    [
        ("hybridid/simulation/shoot.c", {"fit", "residual", "validate", "plot", "trace"}),
        ("hybridid/naming.py", {"preprocess", "fit", "residual", "validate", "plot", "trace"}),
        ("hybridid/signals/butterworth.py", {"preprocess"}),
        ("hybridid/residuals/training.py", {"residual"}),
        ("pipelines/residual/narx.py", {"residual"}),
        ("pipelines/validate.py", {"validate"}),
        ("pipelines/thesis/page.py", set()),
        ("pipelines/sweep/conduct.py", set()),
    ],
)
def test_stages_that_a_changed_file_makes_stale(tmp_path, changed, stale):
    for package in ("hybridid", "pipelines"):
        shutil.copytree(ROOT / package, tmp_path / package, ignore=shutil.ignore_patterns("__pycache__"))
    with (tmp_path / changed).open("a") as file:
        file.write("\n")
    codes = {
        s.name: (code_of(f"pipelines.{s.name}"), code_of(f"pipelines.{s.name}", str(tmp_path)))
        for s in STAGES
    }
    assert {name for name, (before, after) in codes.items() if before != after} == stale


def test_every_import_is_read():
    """What the text is searched for is what Python's own parser finds."""
    missed = {}
    for path in SOURCES:
        text = path.read_text()
        found = set()
        for node in ast.walk(ast.parse(text)):
            if isinstance(node, ast.Import):
                found |= {alias.name for alias in node.names}
            elif isinstance(node, ast.ImportFrom):
                found |= {f"{node.module}.{alias.name}" for alias in node.names}
        missed[path] = found - imported(text)
    assert {path: names for path, names in missed.items() if names} == {}


def test_every_file_that_is_no_python_is_named_by_a_module_above_it():
    """Otherwise nothing would notice that it changed. ``new`` writes no results that could be stale."""
    others = {
        path.relative_to(ROOT).as_posix()
        for package in ("hybridid", "pipelines")
        for path in (ROOT / package).rglob("*")
        if path.is_file()
        and path.suffix not in (".py", ".pyc", ".nbi", ".nbc")
        and not path.is_relative_to(ROOT / "pipelines" / "new")
    }
    assert others <= set(with_imports(path.relative_to(ROOT).as_posix() for path in SOURCES))
    assert "hybridid/simulation/shoot.c" in others
