"""How an effect is sent to another process: by the name under which it can be imported.

Most laws are lambdas, which cannot be pickled. An effect that is defined at the top of a module is sent
as ``module:NAME``; the other process imports it. An effect that is made inside a function is pickled by
its content, which needs a law and dynamics that are plain functions.
"""

from __future__ import annotations

import importlib
import pickle
import sys
from collections.abc import Callable, Sequence
from types import ModuleType
from typing import Any

LIBRARY = f"{__package__}."
"""How the modules of the library's effects begin."""


class EffectNotSendable(pickle.PicklingError, ValueError):
    """Raised for an effect that no other process could import; the message says what to do."""


def reduced(effect: Any) -> tuple[Callable[..., Any], tuple[str, str]] | None:
    """``effect`` as "import this name from that module"; None if it can be pickled by its content.

    Raises:
        EffectNotSendable: if neither is possible.
    """
    functions = [function for function in (effect.law, effect.dynamics) if function is not None]
    of_laws = [str(getattr(function, "__module__", None)) for function in functions]
    library = [name for name in list(sys.modules) if name.startswith(LIBRARY)]
    if where := _home(effect, [*of_laws, *library]):
        return imported, where
    if all(map(_importable, functions)):
        return None
    if where := _home(effect, list(sys.modules)):  # slow: they hold some hundred thousand names
        return imported, where
    raise EffectNotSendable(
        f"effect {effect.id} stands in no module and its law is a lambda or inner function: another "
        f"process cannot find it; write NAME = Effect(...) at the top of a module"
    )


def imported(module: str, name: str) -> Any:
    """The attribute ``name`` of ``module``, imported if need be."""
    return getattr(importlib.import_module(module), name)


def _home(effect: Any, modules: Sequence[str]) -> tuple[str, str] | None:
    """The first of the ``modules`` in which ``effect`` stands, and under which name; None if in none."""
    for module in modules:
        name = _name_in(sys.modules.get(module), effect)
        if name is not None:
            return module, name
    return None


def _name_in(module: ModuleType | None, effect: Any) -> str | None:
    attributes = dict(getattr(module, "__dict__", {}))
    return next((name for name, value in attributes.items() if value is effect), None)


def _importable(function: Callable[..., Any]) -> bool:
    """Whether another process finds the function, or the class of what is called like one."""
    found = function if hasattr(function, "__qualname__") else type(function)
    module = sys.modules.get(found.__module__)
    return getattr(module, found.__qualname__, None) is found
