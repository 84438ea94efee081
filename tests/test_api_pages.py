"""Sphinx builds the documentation without a warning, and every public module of hybridid has a page."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[1]


def public_modules() -> set[str]:
    """The importable name of each file of hybridid."""
    files = [path.relative_to(ROOT).with_suffix("") for path in (ROOT / "hybridid").rglob("*.py")]
    return {".".join(path.parts) for path in files if not path.name.startswith("_")}


def test_documentation_builds_without_a_warning(tmp_path):
    """The dummy builder reads every docstring and resolves every link, but writes no page."""
    command = [sys.executable, "-m", "sphinx", "-W", "--keep-going", "--quiet", "-b", "dummy", "-c", "docs"]
    built = subprocess.run([*command, ".", str(tmp_path)], cwd=ROOT, capture_output=True, text=True)
    assert (built.returncode, built.stderr) == (0, "")
    assert public_modules() <= {page.stem for page in (ROOT / "docs" / "api").glob("*.rst")}
