"""Imports run one way: ``hybridid_cli -> pipelines -> hybridid``; in ``hybridid``, from room to lower room.

The checks read the source (also imports inside functions and under ``TYPE_CHECKING``), so they see what no
test happens to execute. The last tests break each rule in a small tree and see that it is found.
"""

from __future__ import annotations

import ast
import re
import sys
import tomllib
from collections.abc import Iterator, Mapping
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
PACKAGES = ("hybridid", "pipelines", "hybridid_cli")

# a room of hybridid may import its own modules and the rooms of the layers before its own
LAYERS = (
    ("naming", "declarations"),
    ("plain",),
    ("records", "plants", "effects"),
    ("signals", "rigs", "model", "fetch"),
    ("simulation",),
    ("estimators",),
    ("validation",),
    ("residuals",),
    ("hybrid",),
    ("residuals",),
    ("hybrid",),
    ("trace",),
    ("plotting",),
)
LAYER = {room: rank for rank, rooms in enumerate(LAYERS) for room in rooms}

# what a package never imports, directly or lazily
NEVER = {
    "hybridid": ("hydra", "mlflow", "omegaconf", "rich", "pipelines", "hybridid_cli"),
    "pipelines": ("hybridid_cli",),
}
# a virtual rig is integrated by other code than the estimator's: not even through a third module
NEVER_BELOW_RIGS = ("casadi", "hybridid.simulation", "hybridid.effects", "hybridid.model", "hybridid.plants")
STAGES = ("preprocess", "fit", "residual", "validate", "plot", "trace", "report", "sweep", "reproduce")

# distributions whose import name differs, and those that work without being imported
IMPORT_NAME = {"hydra-core": "hydra", "pyyaml": "yaml"}
PLUGINS = {"hydra-joblib-launcher", "hydra-submitit-launcher"}

Graph = Mapping[str, frozenset[str]]


def sources(root: Path) -> Iterator[tuple[str, ast.Module]]:
    """Every module under ``root`` as (dotted name, syntax tree)."""
    for package in PACKAGES:
        for path in sorted((root / package).rglob("*.py")):
            parts = path.relative_to(root).with_suffix("").parts
            yield ".".join(parts[:-1] if parts[-1] == "__init__" else parts), ast.parse(path.read_text())


def imported(tree: ast.Module) -> frozenset[str]:
    """Every module that a syntax tree imports; ``from a import b`` gives ``a`` and ``a.b``."""
    found = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            found |= {"." * node.level} if node.level else {str(node.module)}
            found |= {f"{node.module}.{alias.name}" for alias in node.names if not node.level}
    return frozenset(found)


def import_graph(root: Path) -> Graph:
    """Module -> what it imports, over the three packages under ``root``."""
    return {module: imported(tree) for module, tree in sources(root)}


def within(module: str, package: str) -> bool:
    return module == package or module.startswith(f"{package}.")


def room(module: str) -> str:
    """``hybridid.plants.emps`` -> ``plants``."""
    return [*module.split("."), ""][1]


def reachable(graph: Graph, start: str) -> set[str]:
    """Everything that importing ``start`` can bring in."""
    seen: set[str] = set()
    todo = [start]
    while todo:
        new = graph.get(todo.pop(), frozenset()) - seen
        seen |= new
        todo += new
    return seen


def violations(graph: Graph) -> list[str]:
    """One line for each import that runs the wrong way."""
    return sorted({*_package_rules(graph), *_room_rules(graph), *_stage_rules(graph), *_rig_rules(graph)})


def _package_rules(graph: Graph) -> Iterator[str]:
    for module, names in graph.items():
        if any(name.startswith(".") for name in names):
            yield f"{module} imports relatively"
        for package, never in NEVER.items():
            if within(module, package):
                yield from (f"{module} imports {n}" for n in never if any(within(name, n) for name in names))


def _room_rules(graph: Graph) -> Iterator[str]:
    for module, names in graph.items():
        if not within(module, "hybridid") or not room(module):
            continue
        if room(module) not in LAYER:
            yield f"{module}: no layer of tests/test_imports.py names the room {room(module)!r}"
            continue
        for other in {room(n) for n in names if within(n, "hybridid")} - {"", room(module)}:
            if LAYER.get(other, len(LAYERS)) >= LAYER[room(module)]:
                yield f"{module} imports hybridid.{other}"


def _stage_rules(graph: Graph) -> Iterator[str]:
    stages = {f"pipelines.{stage}" for stage in STAGES}
    for module in stages & graph.keys():
        yield from (f"{module} imports {other}" for other in (stages - {module}) & graph[module])


def _rig_rules(graph: Graph) -> Iterator[str]:
    for module, names in graph.items():
        if within(module, "hybridid.rigs"):
            below = reachable(graph, module)
            yield from (f"{module} reaches {n}" for n in NEVER_BELOW_RIGS if any(within(b, n) for b in below))
        elif within(module, "hybridid") and any(within(n, "hybridid.rigs") for n in names):
            yield f"{module} imports hybridid.rigs: the science must not know its own test bench"


def prints(root: Path) -> list[str]:
    """Calls of ``print`` in ``hybridid``."""
    return [
        f"{module}:{node.lineno} prints"
        for module, tree in sources(root)
        if within(module, "hybridid")
        for node in ast.walk(tree)
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id == "print"
    ]


def test_imports_run_one_way():
    graph = import_graph(ROOT)
    assert len(graph) > 10, "the checker found too few modules to be looking at the project"
    assert violations(graph) == []


def test_science_prints_nothing():
    assert prints(ROOT) == []


def test_dependencies_are_what_is_imported():
    """Each third-party import is declared in pyproject.toml, and nothing declared is idle."""
    requirements = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["dependencies"]
    declared = {re.split(r"[<>=!~\[; ]", requirement)[0] for requirement in requirements}
    tops = {name.split(".")[0] for names in import_graph(ROOT).values() for name in names}
    third_party = tops - set(sys.stdlib_module_names) - set(PACKAGES)
    assert third_party == {IMPORT_NAME.get(name, name) for name in declared - PLUGINS}


GOOD = {
    "hybridid/declarations.py": "import math",
    "hybridid/model.py": "import casadi\nfrom hybridid.declarations import Port",
    "hybridid/records/record.py": "def f():\n    from hybridid.records.checks import check",
    "hybridid/rigs/emps.py": "from hybridid.records.record import Record",
    "hybridid/estimators/fit.py": "from hybridid.model import Model",
    "pipelines/fit.py": "import mlflow\nfrom hybridid.estimators.fit import fit",
    "pipelines/run.py": "from pipelines import fit",
    "hybridid_cli/main.py": "from pipelines.run import run",
}

BAD = (
    ("hybridid/declarations.py", "from hybridid.model import Model", "declarations imports hybridid.model"),
    (
        "hybridid/model.py",
        "def f():\n    import hybridid.estimators.fit",
        "model imports hybridid.estimators",
    ),
    ("hybridid/plants/emps.py", "from hybridid.effects.library import EFFECTS", "imports hybridid.effects"),
    ("hybridid/model.py", "from .declarations import Port", "imports relatively"),
    ("hybridid/attic.py", "import math", "names the room 'attic'"),
    ("hybridid/estimators/fit.py", "import mlflow.tracking", "imports mlflow"),
    ("hybridid/records/load.py", "from omegaconf import DictConfig", "imports omegaconf"),
    ("hybridid/estimators/fit.py", "from pipelines import fit", "imports pipelines"),
    ("hybridid/estimators/fit.py", "from hybridid.rigs import emps", "imports hybridid.rigs"),
    ("hybridid/rigs/emps.py", "import casadi as ca", "reaches casadi"),
    ("hybridid/rigs/emps.py", "from hybridid import model", "reaches hybridid.model"),
    ("hybridid/records/record.py", "import casadi", "rigs.emps reaches casadi"),
    ("pipelines/fit.py", "from hybridid_cli.main import main", "imports hybridid_cli"),
    ("pipelines/fit.py", "from pipelines import validate", "imports pipelines.validate"),
    ("pipelines/validate.py", "import pipelines.fit", "imports pipelines.fit"),
)


def write_tree(root: Path, files: Mapping[str, str]) -> Path:
    for name, text in files.items():
        (root / name).parent.mkdir(parents=True, exist_ok=True)
        (root / name).write_text(text)
    return root


def test_checker_accepts_a_sound_tree(tmp_path):
    assert violations(import_graph(write_tree(tmp_path, GOOD))) == []


@pytest.mark.parametrize(("path", "text", "finding"), BAD)
def test_checker_finds_each_violation(tmp_path, path, text, finding):
    found = violations(import_graph(write_tree(tmp_path, {**GOOD, path: text})))
    assert any(finding in line for line in found), found


def test_checker_finds_a_print(tmp_path):
    write_tree(
        tmp_path, {**GOOD, "hybridid/model.py": "def f():\n    print('cost')", "pipelines/fit.py": "print(1)"}
    )
    assert prints(tmp_path) == ["hybridid.model:2 prints"]
