"""Errors in code of the user's own (a plant, an effect, a rig) as one line: which file, which line, where.

pendulum.py, line 26, in derivative: KeyError: 'q'
"""

from __future__ import annotations

import importlib
import inspect
import linecache
import sysconfig
import traceback
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path
from types import ModuleType, SimpleNamespace
from typing import Any, NoReturn

from hybridid.naming import shortened, unknown

_LIBRARIES = tuple(sysconfig.get_path(name) for name in ("stdlib", "platstdlib", "purelib", "platlib"))
_NOT_THEIRS = (str(Path(__file__).resolve().parent), *_LIBRARIES, "<")
"""How the file names begin of code that is not the user's: this package, Python's own library, what is
installed, what has no file."""


class OwnCodeError(ValueError):
    """Raised for code that a user wrote and that fails; the message names file, line and function."""


@contextmanager
def blamed_on(thing: Any, passing: tuple[type[BaseException], ...] = ()) -> Iterator[None]:
    """Whatever code of ``thing`` raises becomes an ``OwnCodeError``, also the attempt to end the program.

    ``thing`` (an object, a class, a function, a module) says where to look if the error itself does not.
    Exceptions ``passing`` are those that hybridid raises itself.
    """
    try:
        yield
    except OwnCodeError:
        raise
    except passing:
        raise
    except (Exception, SystemExit, GeneratorExit) as raised:
        raise OwnCodeError(f"{_place(raised, thing)}: {_said(raised)}") from raised


def blame(thing: Any, what: str) -> NoReturn:
    """Raise an ``OwnCodeError`` that says ``what`` is wrong with ``thing``."""
    raise OwnCodeError(f"{_defined(thing)}: {what}")


def imported(path: str, what: str) -> Any:
    """The object at ``module:NAME``; ``what`` it is for, in a message.

    Raises:
        OwnCodeError: if the module fails when it is imported.
        ValueError: if the path is malformed, there is no such module, or it lacks the name.
    """
    name, _, attribute = path.partition(":")
    if not name or not attribute or not all(part.isidentifier() for part in name.split(".")):
        raise ValueError(f"{what} is {path!r}: give an import path, module:NAME")
    try:
        with blamed_on(None, passing=(ModuleNotFoundError,)):
            module = importlib.import_module(name)
    except ModuleNotFoundError as error:
        if error.name != name.partition(".")[0] and error.name != name:  # a module that it imports itself
            raise OwnCodeError(f"{what} {path}: {_place(error, None)}: {error}") from error
        raise ValueError(f"{what} {path}: {error}; Python files in --config-dir are found too") from error
    except OwnCodeError as error:
        raise OwnCodeError(f"{what} {path}: {name} fails when imported: {error}") from error
    if not hasattr(module, attribute):
        raise ValueError(f"{what} {path}: {unknown(f'name in {name}', attribute, _own_names(module))}")
    return getattr(module, attribute)


def _own_names(module: ModuleType) -> list[str]:
    """The public names of a module, without the modules, classes and functions that it imports."""

    def imports(value: Any) -> bool:
        made = inspect.isclass(value) or inspect.isroutine(value)
        return inspect.ismodule(value) or (made and value.__module__ != module.__name__)

    return [name for name, value in vars(module).items() if not name.startswith("_") and not imports(value)]


class Named(SimpleNamespace):
    """Values by name; a wrong name is answered with the nearest right one. ``what`` they are, for that."""

    __slots__ = ("_what",)

    def __init__(self, what: str, values: Mapping[str, Any]) -> None:
        super().__init__(**values)
        self._what = what

    def __getattr__(self, name: str) -> NoReturn:
        raise AttributeError(unknown(self._what, name, vars(self)))


def _place(raised: BaseException, thing: Any) -> str:
    """File, line and function of the innermost of the user's lines that led to the error."""
    if isinstance(raised, SyntaxError) and raised.filename:
        return f"{Path(raised.filename).name}, line {raised.lineno}"
    home = _file(thing)
    frames = traceback.extract_tb(raised.__traceback__)[2:]  # without ``blamed_on`` and who uses it
    own = [f for f in frames if f.filename == home or not f.filename.startswith(_NOT_THEIRS)]
    if not own:
        return _defined(thing)
    name = "" if own[-1].name == "<module>" else f", in {own[-1].name.strip('<>')}"
    return f"{Path(own[-1].filename).name}, line {own[-1].lineno}{name}"


def _said(raised: BaseException) -> str:
    if isinstance(raised, SystemExit):
        return "it ends the program (sys.exit or the like), which code of a model must not"
    if isinstance(raised, SyntaxError):
        return f"{type(raised).__name__}: {raised.msg}"
    if isinstance(raised, KeyError):
        return f"KeyError: {shortened(repr(raised.args[0]) if raised.args else '')}"
    # CasADi begins with the place in its own source, and ends with what is wrong
    text = shortened(str(raised).rpartition(".hpp:")[2].rpartition(".cpp:")[2].lstrip("0123456789: "))
    if not text and raised.__traceback__ is not None:
        last = traceback.extract_tb(raised.__traceback__)[-1]
        text = linecache.getline(last.filename, last.lineno or 0).strip()
    return f"{type(raised).__name__}: {text}"


def _file(thing: Any) -> str:
    with suppress(TypeError, OSError):
        return inspect.getsourcefile(_described(thing)) or ""
    return ""


def _described(thing: Any) -> Any:
    """What ``inspect`` knows the source of: an instance stands for its class."""
    kinds = (inspect.isclass, inspect.isroutine, inspect.ismodule)
    return thing if any(is_one(thing) for is_one in kinds) else type(thing)


def _defined(thing: Any) -> str:
    """Where ``thing`` is written."""
    with suppress(TypeError, OSError):
        found = _described(thing)
        line = "" if inspect.ismodule(found) else f", line {inspect.getsourcelines(found)[1]}"
        name = f", {found.__name__}" if inspect.isroutine(found) else ""
        return f"{Path(_file(thing)).name}{line}{name}"
    return repr(thing)[:80]
