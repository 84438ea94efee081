"""The house keeps its promises: what git holds, how modules look, what a wheel carries."""

from __future__ import annotations

import ast
import os
import subprocess
import sys
import tomllib
import zipfile
from importlib import metadata
from pathlib import Path
from typing import Any

import pytest
from hatchling.builders.wheel import WheelBuilder
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name
from packaging.version import Version

ROOT = Path(__file__).parents[1]
PACKAGES = ("hybridid", "pipelines", "hybridid_cli", "hydra_plugins")
MODULES = [path for package in PACKAGES for path in sorted((ROOT / package).rglob("*.py"))]
LONGEST = 350
# records come in these; the project makes its own in tests, and ships none
RECORD_SUFFIXES = {".mat", ".parquet", ".h5", ".hdf5", ".npz", ".npy", ".zip", ".tdms", ".mf4", ".dat"}
LARGEST = 256 * 1024


def output_of(words: list[str], **options: Any) -> str:
    return subprocess.run(words, check=True, capture_output=True, text=True, **options).stdout


def tracked() -> list[Path]:
    """Every file that git holds."""
    try:
        listing = subprocess.run(
            ["git", "ls-files", "-z"], cwd=ROOT, check=True, capture_output=True, text=True
        )
    except (OSError, subprocess.CalledProcessError):
        pytest.skip("needs a git checkout")
    return [ROOT / name for name in listing.stdout.split("\0") if name]


def test_git_holds_no_record():
    """No recording, and nothing large enough to be one under another name."""
    suspects = [p for p in tracked() if p.suffix.lower() in RECORD_SUFFIXES or _size(p) > LARGEST]
    assert suspects == []


def test_git_holds_no_measured_record(measured):
    """No file of the measured records, whatever its name, by size and content."""
    recordings = {path.stat().st_size: path for path in measured.rglob("*") if path.is_file()}
    for path in tracked():
        twin = recordings.get(_size(path))
        assert twin is None or twin.read_bytes() != path.read_bytes(), f"{path} is {twin}"


def _size(path: Path) -> int:
    return path.stat().st_size if path.is_file() else 0


@pytest.mark.parametrize("path", MODULES, ids=lambda path: str(path.relative_to(ROOT)))
def test_module_is_short_and_says_what_it_is(path):
    text = path.read_text()
    assert len(text.splitlines()) <= LONGEST
    assert not text.strip() or ast.get_docstring(ast.parse(text)), "has no docstring"


TRAINING = {
    f"hybridid/residuals/{name}.py"
    for name in (
        "adam",
        "samples",
        "course",
        "criteria",
        "stack",
        "training",
        "stretches",
        "objective",
        "second_order",
    )
}


def test_imports_stay_light():
    """The science without its plots loads neither torch nor matplotlib, nor any of the terminal's tools.

    The modules that train networks are torch; whoever needs them imports them when it trains.
    """
    science = [p for p in MODULES if p.is_relative_to(ROOT / "hybridid") and "plotting" not in p.parts]
    light = [p for p in science if not {str(p.relative_to(ROOT))} & TRAINING]
    names = [".".join(p.relative_to(ROOT).with_suffix("").parts).removesuffix(".__init__") for p in light]
    code = f"""
import importlib, sys
for name in {names!r}:
    importlib.import_module(name)
print({{"torch", "matplotlib", "mlflow", "hydra", "omegaconf"}} & set(sys.modules))
"""
    loaded = output_of([sys.executable, "-c", code], env={**os.environ, "PYTHONPATH": str(ROOT)})
    assert loaded.strip() == "set()"


def test_constraints_pin_all_that_is_installed():
    """Every package that hybridid stands on, however deep, has the version that ``constraints.txt`` names."""
    lines = (ROOT / "constraints.txt").read_text().splitlines()
    pins = {canonicalize_name(name): version for name, _, version in (line.partition("==") for line in lines)}
    installed = {name: Version(metadata.version(name)).public for name in _needed()}
    assert installed == {name: pins.get(name, "not pinned") for name in installed}


def _needed() -> set[str]:
    """The packages that pyproject.toml asks for here, and all that they ask for, less CUDA."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    todo = [Requirement(text) for text in project["dependencies"] + project["optional-dependencies"]["dev"]]
    seen: set[tuple[str, str]] = set()
    while todo:
        requirement = todo.pop()
        if requirement.name.startswith(("cuda", "nvidia", "triton")):
            continue
        for extra in {"", *requirement.extras}:
            key = (canonicalize_name(requirement.name), extra)
            if key not in seen:
                seen.add(key)
                below = [Requirement(text) for text in metadata.requires(requirement.name) or []]
                todo += [r for r in below if r.marker is None or r.marker.evaluate({"extra": extra})]
    return {name for name, _ in seen}


def test_wheel_carries_conf_and_editable_does_not(tmp_path):
    """Built for real: a wheel holds ``conf/``, an editable install reads the checkout's own."""
    builder = WheelBuilder(str(ROOT))
    contents = {}
    for version in ("standard", "editable"):
        (wheel,) = builder.build(directory=str(tmp_path / version), versions=[version])
        contents[version] = set(zipfile.ZipFile(wheel).namelist())
    configs = {path.relative_to(ROOT / "conf").as_posix() for path in (ROOT / "conf").rglob("*.yaml")}
    assert configs
    conf = "hybridid_cli/conf/"
    assert configs == {name.removeprefix(conf) for name in contents["standard"] if name.startswith(conf)}
    assert "hybridid_cli/main.py" in contents["standard"]
    beside = (path for path in (ROOT / "pipelines").rglob("templates/*") if path.is_file())
    templates = {path.relative_to(ROOT).as_posix() for path in beside}
    assert templates
    assert templates <= contents["standard"]
    assert not any("conf/" in name for name in contents["editable"])
    outsiders = {name.split("/")[0] for name in contents["standard"]} - set(PACKAGES)
    assert all(name.endswith(".dist-info") for name in outsiders), outsiders


def test_make_without_a_usable_python_says_so_in_one_line(tmp_path):
    words = ["make", "--no-print-directory", "install", f"VENV={tmp_path}/venv", "PYTHON=/no/python3.9"]
    run = subprocess.run(words, cwd=ROOT, capture_output=True, text=True)
    complaint = [line for line in run.stderr.splitlines() if not line.startswith("make")]
    assert run.returncode != 0
    assert len(complaint) == 1
    assert "/no/python3.9" in complaint[0]
    assert "3.11" in complaint[0]
    assert not (tmp_path / "venv").exists()
