"""Every public class, function, method and property of the three packages says what it does."""

from __future__ import annotations

import importlib
import inspect
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType

import pytest

ROOT = Path(__file__).parents[1]
PACKAGES = ("hybridid", "pipelines", "hybridid_cli")
FILES = sorted(file for package in PACKAGES for file in (ROOT / package).rglob("*.py"))
MODULES = [
    ".".join(path.relative_to(ROOT).with_suffix("").parts).removesuffix(".__init__")
    for path in FILES
    if path.name != "__main__.py"  # importing it runs the command
]


def undocumented(module: ModuleType) -> Iterator[str]:
    """The public names that ``module`` defines without a docstring; a method may inherit its own."""
    for name, value in vars(module).items():
        if name.startswith("_") or getattr(value, "__module__", None) != module.__name__:
            continue
        if inspect.isclass(value):
            # a dataclass without a docstring gets its signature for one
            if not value.__doc__ or value.__doc__.startswith(f"{value.__name__}("):
                yield name
            yield from (f"{name}.{member}" for member in undocumented_members(value))
        elif inspect.isroutine(value) and not inspect.getdoc(value):
            yield name


def undocumented_members(owner: type) -> Iterator[str]:
    """The public methods and properties that ``owner`` defines without a docstring, own or inherited."""
    fields = getattr(
        owner, "__dataclass_fields__", {}
    )  # a function as default: the class describes the field
    for name, value in vars(owner).items():
        if name in fields:
            continue
        if isinstance(value, staticmethod | classmethod):
            value = value.__func__
        is_method = inspect.isfunction(value) or isinstance(value, property)
        inherited = (getattr(base, name) for base in owner.__mro__[1:] if hasattr(base, name))
        if is_method and not (name.startswith("_") or value.__doc__ or any(map(inspect.getdoc, inherited))):
            yield name


@pytest.mark.parametrize("name", MODULES)
def test_public_names_have_a_docstring(name):
    assert list(undocumented(importlib.import_module(name))) == []


def test_a_missing_docstring_is_found():
    """The check itself: of four members, only the two that nobody documents are found."""

    class Base:
        def said_here(self):
            """Documented."""

    class Derived(Base):
        def said_here(self):
            return 1

        def silent(self):
            return 2

        @property
        def silent_property(self):
            return 3

        def _private(self):
            return 4

    assert list(undocumented_members(Derived)) == ["silent", "silent_property"]
