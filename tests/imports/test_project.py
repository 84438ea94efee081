"""Imports run one way: ``hybridid_cli -> pipelines -> hybridid``; in a package, from a room to rooms above it
in the list of ``CONTRIBUTING.md``; never in a circle.
"""

from __future__ import annotations

import re
import sys
import tomllib

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


def test_imports_run_one_way(rules):
    graph = rules.import_graph(rules.ROOT)
    assert len(graph) > 10, "the checker found too few modules to be looking at the project"
    assert rules.violations(graph, rules.layers()) == []


def test_every_room_has_one_place(rules):
    """Each room that ``CONTRIBUTING.md`` names is there and named once."""
    layers = rules.layers()
    assert layers.keys() == {"hybridid", "hybridid.trace", "pipelines"}
    assert rules.misnamed(rules.import_graph(rules.ROOT), layers) == []


def test_imports_by_name_are_few_and_known(rules):
    graph = rules.import_graph(rules.ROOT)
    found = {module for module in graph if graph[module] & {"importlib", "importlib.import_module"}}
    assert {module for module in found if module.split(".")[0] in rules.PACKAGES} == BY_NAME.keys()


def test_science_prints_nothing(rules):
    assert rules.prints(rules.ROOT) == []


def test_dependencies_are_what_is_imported(rules):
    """Each third-party import is declared in pyproject.toml, there or in the extra ros, and none is idle."""
    project = tomllib.loads((rules.ROOT / "pyproject.toml").read_text())["project"]
    requirements = project["dependencies"] + project["optional-dependencies"]["ros"]
    declared = {re.split(r"[<>=!~\[; ]", requirement)[0] for requirement in requirements}
    graph = rules.import_graph(rules.ROOT)
    own = [module for module in graph if module.split(".")[0] in rules.PACKAGES]
    tops = {name.split(".")[0] for module in own for name in graph[module]}
    third_party = tops - set(sys.stdlib_module_names) - set(rules.PACKAGES)
    assert third_party == {IMPORT_NAME.get(name, name) for name in declared - PLUGINS}
