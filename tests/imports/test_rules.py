"""The rules of imports find what breaks them: each is broken in a small tree."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import pytest

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
    (
        "hybridid/trace/search.py",
        "from hybridid.residuals.rbf import RBF",
        "imports hybridid.residuals",
    ),
    (
        "hybridid/trace/search.py",
        "def f():\n    from hybridid import hybrid",
        "imports hybridid.hybrid",
    ),
    (
        "hybridid/trace/trials/trial.py",
        "from hybridid.trace.search.steps import Step",
        "trials.trial imports hybridid.trace.search",
    ),
    ("hybridid/trace/attic/old.py", "import math", "does not name the room 'attic' of hybridid.trace"),
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


def test_checker_accepts_a_sound_tree(rules, tmp_path):
    assert rules.violations(rules.import_graph(write_tree(tmp_path, GOOD)), rules.layers()) == []


@pytest.mark.parametrize(("path", "text", "finding"), BAD)
def test_checker_finds_each_violation(rules, tmp_path, path, text, finding):
    found = rules.violations(rules.import_graph(write_tree(tmp_path, {**GOOD, path: text})), rules.layers())
    assert any(finding in line for line in found), found


def test_checker_finds_a_print(rules, tmp_path):
    write_tree(
        tmp_path,
        {**GOOD, "hybridid/model/model.py": "def f():\n    print('cost')", "pipelines/fit.py": "print(1)"},
    )
    assert rules.prints(tmp_path) == ["hybridid.model.model:2 prints"]


def test_checker_finds_misnamed_rooms(rules, tmp_path):
    graph = rules.import_graph(
        write_tree(tmp_path, {"hybridid/model/__init__.py": "", "hybridid/records/__init__.py": ""})
    )
    layers = {"hybridid": [["model", "records"], ["report"], ["model"]]}
    assert rules.misnamed(graph, layers) == [
        "hybridid.model has two places",
        "hybridid.report does not exist",
    ]


def test_layers_are_read_from_the_list_of_rooms(rules):
    text = "```\na -> b\n```\nwords\n```\nb     low, base\n      high\n\na     only\n```\n"
    assert rules.layers_of(text) == {"b": [["low", "base"], ["high"]], "a": [["only"]]}
