"""The source code that a result depends on: its files, their digests, the versions of numerical libraries.

The files follow from the imports: a module's own file, every module of the project that it imports, directly
or through others, at its top or inside a function, and the ``__init__`` of the packages that hold them. Files
that are not Python (``shoot.c``) count if a module in their folder, or one above, contains their name. So do
the Python files in a user's own folder. Imports are read from the text of the files: no code is run, and no
list must be maintained.
"""

from __future__ import annotations

import hashlib
import os
import re
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cache
from importlib import metadata
from pathlib import Path

import hybridid

PROJECT = str(Path(hybridid.__file__).resolve().parents[1])
PACKAGES = ("hybridid", "pipelines", "benchmarks")
NUMERICAL = ("casadi", "numba", "numpy", "pandas", "scipy", "torch")
"""Libraries whose version can change a number."""

_IMPORT = re.compile(r"^[ \t]*(?:from[ \t]+([\w.]+)[ \t]+import[ \t]+(\([^)]*\)|.*)|import[ \t]+(.*))", re.M)
_COMMENT = re.compile(r"#.*")


@cache
def code_of(module: str, root: str = PROJECT) -> dict[str, str]:
    """The code that ``module`` runs: SHA-256 of its files by subpackage (``hybridid.model``), and the version
    of each numerical library. The name of a package stands for all its modules.

    Raises:
        ValueError: if there is no such module below ``root``.
    """
    files = files_of(module, root)
    rooms: dict[str, list[str]] = {}
    for file in files:
        rooms.setdefault(".".join(file.removesuffix(".py").split("/")[:2]), []).append(file)
    libraries = {library for file in files for library in _source(file, root).libraries}
    return {
        **{room: digest(rooms[room], root) for room in sorted(rooms)},
        **{library: _version(library) for library in sorted(libraries)},
    }


def files_of(module: str, root: str = PROJECT) -> list[str]:
    """Every source file that ``module`` runs, its own included, as sorted paths relative to ``root``; see
    ``code_of``."""
    place = module.replace(".", "/")
    own = [name for name in _tree(root) if name == f"{place}.py" or name.startswith(f"{place}/")]
    if not own:
        raise ValueError(f"{module}: no such module in {root}")
    return with_imports([*(name for name in own if name.endswith(".py")), *_run_by(module, root)], root)


def with_imports(files: Iterable[str], root: str = PROJECT) -> list[str]:
    """``files`` and all files below ``root`` that they import, directly or through others, sorted."""
    found: set[str] = set()
    todo = list(files)
    while todo:
        file = todo.pop()
        if file not in found:
            found.add(file)
            todo += _source(file, root).uses
    return sorted(found)


def digest(files: Iterable[str], root: str = PROJECT) -> str:
    """SHA-256 over the names and contents of ``files``. A user's own files have absolute paths; of these only
    the last part counts."""
    parts = [(Path(f).name if f.startswith("/") else f, _source(f, root).digest) for f in files]
    return hashlib.sha256(repr(parts).encode()).hexdigest()


def imported(text: str) -> set[str]:
    """Every name that the Python ``text`` imports, dotted in full: ``from a import b`` gives ``a.b``."""
    found = set()
    for module, names, modules in _IMPORT.findall(text):
        for entry in _COMMENT.sub("", names or modules).strip("() \t").split(","):
            if entry.strip():
                name = entry.split()[0]
                found.add(f"{module}.{name}" if module else name)
    return found


@dataclass(frozen=True)
class _Source:
    """A file's SHA-256, the files that it uses directly and the numerical libraries that it imports."""

    digest: str
    uses: tuple[str, ...] = ()
    libraries: frozenset[str] = frozenset()


@cache
def _source(file: str, root: str) -> _Source:
    path = Path(root, file)  # an absolute path stays as it is
    with path.open("rb") as stream:
        sha256 = hashlib.file_digest(stream, "sha256").hexdigest()
    if path.suffix != ".py":  # a user's data may be large: it is not kept in memory
        return _Source(sha256)
    text = path.read_text(encoding="utf-8", errors="replace")
    names = imported(text)
    uses = [below for name in names for below in _run_by(name, root)]
    folder = file.removesuffix(path.name)
    uses += [other for other in _not_python(folder, root) if other.rpartition("/")[2] in text]
    uses += [other for other in _beside(folder) if other != file and _mentions(text, Path(other).stem)]
    tops = {name.partition(".")[0] for name in names}
    return _Source(sha256, tuple(uses), frozenset(tops.intersection(NUMERICAL)))


def _run_by(name: str, root: str) -> list[str]:
    """The files that run when ``name`` is imported: its module and the packages that hold it; none if it is
    not below ``root``."""
    found = []
    parts = name.split(".")
    for k in range(1, len(parts) + 1):
        place = "/".join(parts[:k])
        found += [file for file in (f"{place}/__init__.py", f"{place}.py") if file in _tree(root)]
    return found


@cache
def _tree(root: str) -> frozenset[str]:
    """Every file of the project's packages, as paths relative to ``root``."""
    walks = (walk for package in PACKAGES for walk in os.walk(f"{root}/{package}"))
    return frozenset(
        f"{folder}/{file}".removeprefix(f"{root}/")
        for folder, _, files in walks
        for file in files
        if not folder.endswith("__pycache__")
    )


@cache
def _not_python(folder: str, root: str) -> tuple[str, ...]:
    """The files that are not Python: in a ``folder`` of the project and below, or in a user's own folder."""
    if folder.startswith("/"):
        names = [entry.path for entry in os.scandir(folder) if entry.is_file()]
    else:
        names = [name for name in _tree(root) if name.startswith(folder)]
    return tuple(name for name in names if not name.endswith(".py"))


@cache
def _beside(folder: str) -> tuple[str, ...]:
    """The Python files in a user's own ``folder``; none in a folder of the project, whose imports tell."""
    return tuple(str(path) for path in Path(folder).glob("*.py")) if folder.startswith("/") else ()


def _mentions(text: str, name: str) -> bool:
    """Whether ``name`` stands in ``text`` as a word: it may be imported by any means."""
    return re.search(rf"\b{re.escape(name)}\b", text) is not None


@cache
def _version(library: str) -> str:
    return metadata.version(library)
