"""Objects that a config names by import path, ``module:NAME``, and the code behind them."""

from __future__ import annotations

import importlib
import inspect
from collections.abc import Iterable
from pathlib import Path
from types import ModuleType
from typing import Any

from pipelines.shared.errors import ConfigError, unknown
from pipelines.shared.own_code import check_not_taken
from pipelines.shared.source_code import PACKAGES, PROJECT, digest, files_of, with_imports


def named(path: object, what: str) -> Any:
    """The object at ``module:NAME``.

    Raises:
        ConfigError: if the path is malformed, the module cannot be imported or lacks the name, or a library
            has the name of the user's module.
    """
    module_name, _, attribute = str(path).partition(":")
    if not module_name or not attribute:
        raise ConfigError(f"{what} is {path!r}: give an import path, module:NAME")
    check_not_taken(module_name, f"{what} {path}")
    try:
        module = importlib.import_module(module_name)
    except ImportError as error:
        raise ConfigError(f"{what} {path}: {error}; Python files in --config-dir are found too") from error
    except Exception as error:  # the user's own file may raise anything: the message says where
        raise ConfigError(f"{what} {path}: {module_name} fails when imported: {_where(error)}") from error
    if not hasattr(module, attribute):
        raise ConfigError(f"{what} {path}: {unknown(f'name in {module_name}', attribute, _public(module))}")
    return getattr(module, attribute)


def code_digests(paths: Iterable[str]) -> dict[str, str]:
    """SHA-256 of the code behind import paths, each with a description of the code as its key.

    For a user's module the digests cover the Python files beside it and the modules of hybridid that they
    import. For a module of hybridid they cover the module and all that it imports.
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
        reached = with_imports(str(own) for own in file.parent.glob("*.py"))
        theirs = [name for name in reached if Path(name).is_absolute()]
        found[f"code beside {file.name}"] = digest(theirs)
        found[f"hybridid's code for {file.name}"] = digest(name for name in reached if name not in theirs)
    return found


def _public(module: ModuleType) -> list[str]:
    return [
        name
        for name, value in vars(module).items()
        if not name.startswith("_") and not inspect.ismodule(value)
    ]


def _where(error: Exception) -> str:
    trace = inspect.getinnerframes(error.__traceback__) if error.__traceback__ else []
    place = f" ({Path(trace[-1].filename).name}, line {trace[-1].lineno})" if trace else ""
    return f"{type(error).__name__}: {error}{place}"
