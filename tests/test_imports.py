"""Imports run one way: ``hybridid_cli -> pipelines -> hybridid``; in a package, from a room to rooms above it
in the list of ``CONTRIBUTING.md``; never in a circle.

The checks read the source (also imports inside functions and under ``TYPE_CHECKING``), so they see what no
test happens to execute. The last tests break each rule in a small tree and see that it is found.
"""

from __future__ import annotations

import ast
import re
import sys
import tomllib
from collections.abc import Iterator, Mapping, Sequence
from functools import cache
from graphlib import CycleError, TopologicalSorter
from itertools import accumulate
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
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

# imports that no text shows: these modules may import by a name that they are given
BY_NAME = {
    "hybridid.blame": "plant, effect and rig of the user's own",
    "hybridid.effects.pickling": "functions that came through a pickle",
    "pipelines.new.template": "a template's plant, by the template's name",
    "pipelines.shared.imports": "their code counts for freshness",
    "hybridid_cli.main": "the command's own module, so that a command starts fast",
}

# distributions whose import name differs, and those that work without being imported
IMPORT_NAME = {"mcap-ros2-support": "mcap_ros2", "hydra-core": "hydra", "pyyaml": "yaml"}
PLUGINS = {"hydra-joblib-launcher", "hydra-submitit-launcher"}


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


LAYERS = layers_of((ROOT / ROOMS_FILE).read_text())


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


def room(module: str) -> str:
    """``hybridid.plants.emps`` -> ``plants``."""
    return [*module.split("."), ""][1]


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
            if not within(module, package) or not room(module):
                continue
            if room(module) not in rank:
                yield f"{module}: {ROOMS_FILE} does not name the room {room(module)!r} of {package}"
                continue
            others = {room(name) for name in graph[module] if within(name, package)} & rank.keys()
            for other in others - {room(module)}:
                if rank[other] >= rank[room(module)]:
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


def test_imports_run_one_way():
    graph = import_graph(ROOT)
    assert len(graph) > 10, "the checker found too few modules to be looking at the project"
    assert violations(graph, LAYERS) == []


def test_every_room_has_one_place():
    """Each room that ``CONTRIBUTING.md`` names is there and named once."""
    assert LAYERS.keys() == {"hybridid", "pipelines"}
    assert misnamed(import_graph(ROOT), LAYERS) == []


def test_imports_by_name_are_few_and_known():
    graph = import_graph(ROOT)
    found = {module for module in graph if graph[module] & {"importlib", "importlib.import_module"}}
    assert {module for module in found if module.split(".")[0] in PACKAGES} == BY_NAME.keys()


def test_science_prints_nothing():
    assert prints(ROOT) == []


def test_dependencies_are_what_is_imported():
    """Each third-party import is declared in pyproject.toml, there or in the extra ros, and none is idle."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    requirements = project["dependencies"] + project["optional-dependencies"]["ros"]
    declared = {re.split(r"[<>=!~\[; ]", requirement)[0] for requirement in requirements}
    graph = import_graph(ROOT)
    own = [module for module in graph if module.split(".")[0] in PACKAGES]
    tops = {name.split(".")[0] for module in own for name in graph[module]}
    third_party = tops - set(sys.stdlib_module_names) - set(PACKAGES)
    assert third_party == {IMPORT_NAME.get(name, name) for name in declared - PLUGINS}


GOOD = {
    "hybridid/declarations.py": "import math",
    "hybridid/model/__init__.py": "from hybridid.model.model import Model",
    "hybridid/model/model.py": "import casadi\nfrom hybridid.declarations import Port",
    "hybridid/records/record.py": "def f():\n    from hybridid.records.checks import check",
    "hybridid/records/checks.py": "import math",
    "hybridid/rigs/emps.py": "from hybridid.records.record import Record",
    "hybridid/estimators/__init__.py": "from hybridid.estimators.fit import fit",
    "hybridid/estimators/fit.py": "from hybridid.estimators import start\nfrom hybridid.model import Model",
    "hybridid/estimators/start.py": "import math",
    "hybridid/trace/search.py": "from hybridid.estimators import fit",
    "pipelines/shared/tree.py": "import math",
    "pipelines/tracking/runs.py": "import mlflow\nfrom pipelines.shared import tree",
    "pipelines/fit.py": "from hybridid.estimators.fit import fit",
    "pipelines/residual/stage.py": "from pipelines.residual import narx",
    "pipelines/residual/narx.py": "from pipelines.shared.tree import locked",
    "pipelines/runner.py": "from pipelines import fit\nfrom pipelines.residual.stage import RESIDUAL",
    "pipelines/tune/conduct.py": "from pipelines.runner import run_stages\nimport pipelines.tracking.runs",
    "pipelines/tune/trial.py": "def f():\n    from pipelines.residual.narx import train",
    "hybridid_cli/main.py": "from pipelines.runner import run_stages",
    "benchmarks/league/report.py": "from benchmarks.league import play",
    "benchmarks/league/play.py": "from hybridid_cli.main import main",
}
UNDER_TYPE_CHECKING = "from typing import TYPE_CHECKING\nif TYPE_CHECKING:\n    "

BAD = (
    ("hybridid/declarations.py", "from hybridid.model import Model", "declarations imports hybridid.model"),
    (
        "hybridid/model/model.py",
        "def f():\n    import hybridid.estimators.fit",
        "imports hybridid.estimators",
    ),
    ("hybridid/plants/emps.py", "from hybridid.effects.library import EFFECTS", "imports hybridid.effects"),
    ("hybridid/plants/emps.py", "from hybridid import effects", "imports hybridid.effects"),
    ("hybridid/trace/search.py", "from hybridid.residuals.rbf import RBF", "imports hybridid.residuals"),
    ("hybridid/trace/search.py", "def f():\n    from hybridid import hybrid", "imports hybridid.hybrid"),
    ("hybridid/hybrid/hybrid.py", "from hybridid.trace.verdict import trace", "imports hybridid.trace"),
    ("hybridid/validation/metrics.py", "import hybridid.residuals.rbf", "imports hybridid.residuals"),
    ("hybridid/model/model.py", "from .declarations import Port", "imports relatively"),
    ("hybridid/model/model.py", "from . import term", "imports relatively"),
    ("hybridid/attic.py", "import math", "does not name the room 'attic' of hybridid"),
    ("pipelines/attic/stage.py", "import math", "does not name the room 'attic' of pipelines"),
    ("hybridid/estimators/fit.py", "import mlflow.tracking", "imports mlflow"),
    ("hybridid/records/load.py", "from omegaconf import DictConfig", "imports omegaconf"),
    ("hybridid/estimators/fit.py", "from pipelines import fit", "imports pipelines"),
    ("hybridid/estimators/fit.py", "from hybridid.rigs import emps", "imports hybridid.rigs"),
    ("hybridid/rigs/emps.py", "import casadi as ca", "reaches casadi"),
    ("hybridid/rigs/emps.py", "from hybridid import model", "reaches hybridid.model"),
    ("hybridid/records/record.py", "import casadi", "rigs.emps reaches casadi"),
    ("hybridid/records/__init__.py", "import casadi", "rigs.emps reaches casadi"),
    ("pipelines/fit.py", "from hybridid_cli.main import main", "imports hybridid_cli"),
    ("pipelines/fit.py", "from pipelines import validate", "pipelines.fit imports pipelines.validate"),
    ("pipelines/validate.py", "import pipelines.fit", "imports pipelines.fit"),
    ("pipelines/fit.py", "from pipelines.residual.narx import train", "fit imports pipelines.residual"),
    ("pipelines/residual/narx.py", "from pipelines.validate import rows", "imports pipelines.validate"),
    (
        "pipelines/residual/narx.py",
        "def f():\n    import pipelines.validate",
        "residual.narx imports pipelines.validate",
    ),
    (
        "pipelines/plot/laws.py",
        UNDER_TYPE_CHECKING + "from pipelines.trace.stage import TRACE",
        "plot.laws imports pipelines.trace",
    ),
    ("pipelines/trace/stage.py", "from pipelines.runner import run_stages", "imports pipelines.runner"),
    ("pipelines/runner.py", "from pipelines.tune.conduct import tune", "imports pipelines.tune"),
    (
        "pipelines/tune/trial.py",
        "from pipelines.sweep.conduct import sweep",
        "tune.trial imports pipelines.sweep",
    ),
    ("pipelines/sweep/work.py", "def f():\n    import pipelines.tune.trial", "imports pipelines.tune"),
    ("pipelines/sweep/thesis.py", "from pipelines.reproduce import reproduce", "imports pipelines.reproduce"),
    ("pipelines/shared/tree.py", "from pipelines.tracking.runs import tracked", "imports pipelines.tracking"),
    ("pipelines/tracking/runs.py", "from pipelines.fit import FIT", "imports pipelines.fit"),
    ("hybridid/records/checks.py", "from hybridid.records.record import Record", "a circle of imports"),
    (
        "hybridid/records/checks.py",
        UNDER_TYPE_CHECKING + "from hybridid.records.record import Record",
        "a circle of imports",
    ),
    ("hybridid/estimators/start.py", "from hybridid.estimators.fit import fit", "a circle of imports"),
    ("pipelines/residual/narx.py", "def f():\n    import pipelines.residual.stage", "a circle of imports"),
    ("hybridid/model/model.py", "from hybridid.model import compose", "a circle of imports"),
    ("benchmarks/league/play.py", "def f():\n    import benchmarks.league.report", "a circle of imports"),
    ("hybridid/estimators/fit.py", "from benchmarks.league import play", "fit imports benchmarks"),
    ("pipelines/fit.py", "import hydra_plugins.hybridid_sweeper", "fit imports hydra_plugins"),
)


def write_tree(root: Path, files: Mapping[str, str]) -> Path:
    for name, text in files.items():
        (root / name).parent.mkdir(parents=True, exist_ok=True)
        (root / name).write_text(text)
    return root


def test_checker_accepts_a_sound_tree(tmp_path):
    assert violations(import_graph(write_tree(tmp_path, GOOD)), LAYERS) == []


@pytest.mark.parametrize(("path", "text", "finding"), BAD)
def test_checker_finds_each_violation(tmp_path, path, text, finding):
    found = violations(import_graph(write_tree(tmp_path, {**GOOD, path: text})), LAYERS)
    assert any(finding in line for line in found), found


def test_checker_finds_a_print(tmp_path):
    write_tree(
        tmp_path,
        {**GOOD, "hybridid/model/model.py": "def f():\n    print('cost')", "pipelines/fit.py": "print(1)"},
    )
    assert prints(tmp_path) == ["hybridid.model.model:2 prints"]


def test_checker_finds_misnamed_rooms(tmp_path):
    graph = import_graph(
        write_tree(tmp_path, {"hybridid/model/__init__.py": "", "hybridid/records/__init__.py": ""})
    )
    layers = {"hybridid": [["model", "records"], ["report"], ["model"]]}
    assert misnamed(graph, layers) == ["hybridid.model has two places", "hybridid.report does not exist"]


def test_layers_are_read_from_the_list_of_rooms():
    text = "```\na -> b\n```\nwords\n```\nb     low, base\n      high\n\na     only\n```\n"
    assert layers_of(text) == {"b": [["low", "base"], ["high"]], "a": [["only"]]}
