"""The rules of imports, checked in the source (also imports inside functions and under ``TYPE_CHECKING``): so
they see what no test happens to execute.
"""

from __future__ import annotations

import ast
import sys
from collections.abc import Iterator, Mapping, Sequence
from functools import cache
from graphlib import CycleError, TopologicalSorter
from itertools import accumulate
from pathlib import Path
from types import ModuleType

import pytest

ROOT = Path(__file__).parents[2]
PACKAGES = ("hybridid", "pipelines", "hybridid_cli")
AROUND = ("hydra_plugins", "benchmarks")
ROOMS_FILE = "CONTRIBUTING.md"

Graph = Mapping[str, frozenset[str]]
Layers = Mapping[str, Sequence[Sequence[str]]]

# what a room or package never imports, directly or lazily, beside what the layers forbid
NEVER = {
    "hybridid": ("hydra", "mlflow", "omegaconf", "rich", "pipelines", "hybridid_cli", *AROUND),
    "hybridid.hybrid": ("hybridid.trace",),
    "pipelines": ("hybridid_cli", *AROUND),
    "hybridid_cli": AROUND,
}
# a virtual rig is integrated by other code than the estimator's: not even through a third module
NEVER_BELOW_RIGS = ("casadi", "hybridid.simulation", "hybridid.effects", "hybridid.model", "hybridid.plants")


def layers_of(text: str) -> dict[str, list[list[str]]]:
    """Package -> its layers, lowest first.

    They stand in the first block of ``text`` without an arrow: a line gives a package and the rooms of its
    lowest layer, an indented line the rooms of the next layer.
    """
    block = next(part for part in text.split("```")[1::2] if "->" not in part)
    found: dict[str, list[list[str]]] = {}
    package = ""
    for line in filter(str.strip, block.splitlines()):
        if not line.startswith(" "):
            package, line = line.split(maxsplit=1)
            found[package] = []
        found[package].append([name.strip() for name in line.split(",")])
    return found


@cache
def layers() -> Layers:
    """The layers of the project."""
    return layers_of((ROOT / ROOMS_FILE).read_text())


def sources(root: Path, packages: Sequence[str]) -> Iterator[tuple[str, ast.Module]]:
    """Every module of ``packages`` under ``root`` as (dotted name, syntax tree)."""
    for package in packages:
        for path in sorted((root / package).rglob("*.py")):
            parts = path.relative_to(root).with_suffix("").parts
            yield ".".join(parts[:-1] if parts[-1] == "__init__" else parts), ast.parse(path.read_text())


def imported(tree: ast.Module) -> frozenset[str]:
    """Every name that a syntax tree imports, dotted in full: ``from a import b`` gives ``a.b``."""
    found = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            found |= {f"{'.' * node.level}{node.module or ''}.{alias.name}" for alias in node.names}
    return frozenset(found)


@cache
def import_graph(root: Path) -> Graph:
    """Module -> the names that it imports, over the packages under ``root`` and what stands around them."""
    return {module: imported(tree) for module, tree in sources(root, (*PACKAGES, *AROUND))}


def within(module: str, package: str) -> bool:
    return module == package or module.startswith(f"{package}.")


def room(module: str, package: str) -> str:
    """``plants`` for ``hybridid.plants.emps`` in ``hybridid``; empty for the package itself."""
    return module.removeprefix(package).lstrip(".").partition(".")[0]


def owner(graph: Graph, name: str) -> str:
    """The module that holds an imported name; empty if it is none of the graph's."""
    while name and name not in graph:
        name = name.rpartition(".")[0]
    return name


def reachable(graph: Graph, start: str) -> set[str]:
    """Every name that importing ``start`` can bring in, also through the ``__init__`` of a package."""
    seen: set[str] = set()
    done: set[str] = set()
    todo = [start]
    while todo:
        module = todo.pop()
        if module and module not in done:
            done.add(module)
            names = graph.get(module, frozenset())
            seen |= names
            for name in names:  # importing a.b.c runs a, a.b and a.b.c
                todo += accumulate(owner(graph, name).split("."), "{}.{}".format)
    return seen


def violations(graph: Graph, layers: Layers) -> list[str]:
    """One line for each import that runs the wrong way."""
    found = {*_package_rules(graph), *_layer_rules(graph, layers), *_rig_rules(graph), *_circles(graph)}
    return sorted(found)


def _package_rules(graph: Graph) -> Iterator[str]:
    for module, names in graph.items():
        if any(name.startswith(".") for name in names):
            yield f"{module} imports relatively"
        for package, never in NEVER.items():
            if within(module, package):
                yield from (f"{module} imports {n}" for n in never if any(within(name, n) for name in names))


def _layer_rules(graph: Graph, layers: Layers) -> Iterator[str]:
    """A room imports rooms of lower layers: not of its own, so that stages meet through files alone."""
    for package in layers:
        rank = {name: k for k, layer in enumerate(layers[package]) for name in layer}
        for module in graph:
            own = room(module, package) if within(module, package) else ""
            if not own:
                continue
            if own not in rank:
                yield f"{module}: {ROOMS_FILE} does not name the room {own!r} of {package}"
                continue
            others = {room(name, package) for name in graph[module] if within(name, package)} & rank.keys()
            for other in others - {own}:
                if rank[other] >= rank[own]:
                    yield f"{module} imports {package}.{other}"


def _rig_rules(graph: Graph) -> Iterator[str]:
    for module, names in graph.items():
        if within(module, "hybridid.rigs"):
            below = reachable(graph, module)
            yield from (f"{module} reaches {n}" for n in NEVER_BELOW_RIGS if any(within(b, n) for b in below))
        elif within(module, "hybridid") and any(within(n, "hybridid.rigs") for n in names):
            yield f"{module} imports hybridid.rigs: the science must not know its own test bench"


def _circles(graph: Graph) -> Iterator[str]:
    """The first circle of modules that import each other, if there is one."""
    modules = {module: {owner(graph, name) for name in graph[module]} - {module, ""} for module in graph}
    try:
        TopologicalSorter(modules).prepare()
    except CycleError as error:
        yield f"a circle of imports: {' <- '.join(error.args[1])}"


def misnamed(graph: Graph, layers: Layers) -> list[str]:
    """Rooms that the layers name twice, and rooms that the tree does not have."""
    named = [f"{package}.{name}" for package in layers for layer in layers[package] for name in layer]
    twice = {f"{name} has two places" for name in named if named.count(name) > 1}
    return sorted(twice | {f"{name} does not exist" for name in named if name not in graph})


def prints(root: Path) -> list[str]:
    """Calls of ``print`` in ``hybridid``."""
    return [
        f"{module}:{node.lineno} prints"
        for module, tree in sources(root, ["hybridid"])
        for node in ast.walk(tree)
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id == "print"
    ]


@pytest.fixture
def rules() -> ModuleType:
    """This module: its functions find what breaks a rule."""
    return sys.modules[__name__]
