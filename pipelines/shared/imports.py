"""Objects that a config names by import path, ``module:NAME``, and the code behind them."""

from __future__ import annotations

import importlib
import inspect
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from hybridid.blame import OwnCodeError, blamed_on, imported
from pipelines.shared.errors import ConfigError
from pipelines.shared.own_code import check_not_taken
from pipelines.shared.source_code import PACKAGES, PROJECT, digest, files_of, with_imports


def named(path: object, what: str) -> Any:
    """The object at ``module:NAME``.

    Raises:
        ConfigError: in one line, if the path is malformed, the module cannot be imported or lacks the name,
            or a library has the name of the user's module.
    """
    module, _, attribute = str(path).partition(":")
    if module and attribute:  # before it is imported, for to import a module is to run it
        check_not_taken(module, f"{what} {path}")
    try:
        return imported(str(path), what)
    except ValueError as error:
        raise ConfigError(str(error)) from error


def made(path: object, what: str, kind: type[Any], passing: tuple[type[Exception], ...] = ()) -> Any:
    """The object of this ``kind`` at ``module:NAME``, which names it or its class, made without arguments.

    ``passing`` are exceptions of hybridid's own, whose message is complete.

    Raises:
        ConfigError: in one line, as ``named``, or if it is of another kind.
    """
    refused: tuple[type[Exception], ...] = (OwnCodeError, *passing)
    found = named(path, what)
    if inspect.isclass(found) and issubclass(found, kind):
        try:
            with blamed_on(found, passing):
                return found()
        except refused as error:
            raise ConfigError(f"{what} {path}: {error}") from error
    if not isinstance(found, kind):
        given = "class" if inspect.isclass(found) else type(found).__name__
        raise ConfigError(f"{what} {path} is a {given}, not a {kind.__module__}.{kind.__name__}")
    return found


def code_digests(paths: Iterable[str]) -> dict[str, str]:
    """SHA-256 of the code behind import paths, each with a description of the code as its key.

    For a user's module the digests cover it, the files beside it whose names it contains, directly or through
    others, and the modules of hybridid that they import. For a module of hybridid they cover the module and
    all that it imports.
    """
    found: dict[str, str] = {}
    for path in paths:
        module = importlib.import_module(path.partition(":")[0])
        source = inspect.getsourcefile(module)
        if source is None:
            continue
        file = Path(source).resolve()
        if file.is_relative_to(PROJECT) and module.__name__.partition(".")[0] in PACKAGES:
            found[f"the code of {module.__name__}"] = digest(files_of(module.__name__))
            continue
        reached = with_imports([str(file)])
        theirs = [name for name in reached if Path(name).is_absolute()]
        found[f"the code of {file.name}"] = digest(theirs)
        found[f"hybridid's code for {file.name}"] = digest(name for name in reached if name not in theirs)
    return found
