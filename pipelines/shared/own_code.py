"""The user's own Python files: how they are imported, and the digest of a folder's code.

Folders of the user's own come last in the path: no file there takes the place of a library. What is loaded is
the source as one reads it; bytecode that lies beside it is neither read nor written.
"""

from __future__ import annotations

import hashlib
import importlib.util
import os
import sys
from collections.abc import Iterable
from importlib.machinery import (
    EXTENSION_SUFFIXES,
    SOURCE_SUFFIXES,
    ExtensionFileLoader,
    FileFinder,
    ModuleSpec,
    SourceFileLoader,
)
from pathlib import Path

from pipelines.shared.errors import ConfigError

MOST_FILES = 2000
"""A folder with more files of code than this is refused: it is unlikely to hold only models."""
_SUFFIXES = (*SOURCE_SUFFIXES, *EXTENSION_SUFFIXES)
_folders: list[Path] = []


def make_importable(folders: Iterable[Path]) -> None:
    """Let Python files in a user's folder, and beside its case files, be imported by name.

    Only for folders that the user named or trusts: to import a module is to run it.
    """
    new = [folder for folder in dict.fromkeys(folders) if folder not in _folders]
    for folder in new:
        _folders.append(folder)
        sys.path += [place for place in _places(folder) if place not in sys.path]
    if _finder_of not in sys.path_hooks:
        sys.path_hooks.insert(0, _finder_of)
    found_before = [path for path in sys.path_importer_cache if _is_own(path)] if new else []
    for path in found_before:
        del sys.path_importer_cache[path]  # it may have been found by Python's own finder


def importable() -> tuple[Path, ...]:
    """The folders that ``make_importable`` was given in this process."""
    return tuple(_folders)


def folder_with(module: str, folders: Iterable[Path]) -> Path | None:
    """The first of ``folders`` in which ``module`` lies, by the first part of its name."""
    top = module.partition(".")[0]
    found = (f for f in folders for place in _places(f) if _finder(place).find_spec(top) is not None)
    return next(found, None)


def check_not_taken(module: str, what: str) -> None:
    """Check that a module of the user's own is the one that is imported under its name.

    Raises:
        ConfigError: if a library, or a module from another folder, has the name of ``module`` already.
    """
    folder = folder_with(module, _folders)
    if folder is not None:
        check_comes_from(folder, module, what)


def check_comes_from(folder: Path, module: str, what: str) -> None:
    """The same, of a ``module`` that must lie in ``folder``."""
    top = module.partition(".")[0]
    loaded = sys.modules.get(top)
    spec = loaded.__spec__ if loaded is not None else importlib.util.find_spec(top)
    origins = _origins(spec)
    if not any(Path(origin).resolve().is_relative_to(folder.resolve()) for origin in origins):
        raise ConfigError(
            f"{what}: {top} is already the name of {origins[0]}; give {top} in {folder} another name"
        )


def digest_of_code(folder: Path) -> str:
    """SHA-256 over the names and contents of all code in a folder and below.

    Raises:
        ConfigError: if it holds too many files of code.
    """
    total = hashlib.sha256()
    for path in code_in(folder):
        content = hashlib.sha256(path.read_bytes()).hexdigest()
        total.update(f"{path.relative_to(folder).as_posix()}\0{content}\0".encode())
    return total.hexdigest()


def code_in(folder: Path) -> list[Path]:
    """Every file in a folder and below that an import could run, sorted; hidden folders are left out.

    Links are followed, as an import follows them.

    Raises:
        ConfigError: if there are more than ``MOST_FILES``.
    """
    found: list[Path] = []
    seen: set[str] = set()
    for place, folders, files in os.walk(folder, followlinks=True):
        real = os.path.realpath(place)
        folders[:] = [] if real in seen else sorted(name for name in folders if not name.startswith("."))
        seen.add(real)
        code = (Path(place, name) for name in files if name.endswith(_SUFFIXES))
        found += [path for path in code if path.is_file()]  # a pipe cannot be imported, and would block
        if max(len(found), len(seen)) > MOST_FILES:
            raise ConfigError(
                f"{folder} holds more than {MOST_FILES} folders or files of code: move your own elsewhere"
            )
    return sorted(found)


class _Source(SourceFileLoader):
    """Loads the source and ignores bytecode, which may come from another source."""

    def path_stats(self, path: str | bytes) -> dict[str, float]:
        raise OSError("a file of the user's own has no bytecode")


def _places(folder: Path) -> list[str]:
    return [str(place) for place in (folder / "case", folder) if place.is_dir()]


def _finder(place: str) -> FileFinder:
    return FileFinder(place, (ExtensionFileLoader, EXTENSION_SUFFIXES), (_Source, SOURCE_SUFFIXES))


def _finder_of(path: str) -> FileFinder:
    """The finder for a place in ``sys.path``, or for a package, of the user's own.

    Raises:
        ImportError: if it is none, which passes it on to Python's own finder.
    """
    if not _is_own(path):
        raise ImportError(f"{path} is not in a folder of the user's own")
    return _finder(path)


def _is_own(path: str) -> bool:
    """Whether the nearest folder above in ``sys.path`` is one of the user's own: an environment may lie below
    that folder, and is none."""
    if not any(Path(path).is_relative_to(folder) for folder in _folders):
        return False
    above = [entry for entry in sys.path if entry and Path(path).is_relative_to(entry)]
    nearest = max(above, key=len, default="")
    return any(nearest in _places(folder) for folder in _folders)


def _origins(spec: ModuleSpec | None) -> list[str]:
    """Where a module comes from; of a package without a file of its own, its folders."""
    if spec is not None and spec.origin:
        return [spec.origin]
    return list(spec.submodule_search_locations or ()) if spec else ["a module without a file"]
