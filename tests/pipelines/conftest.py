"""A case made in the test: the EMPS plant over a short record of its rig, written as a measured CSV file."""

from __future__ import annotations

import json
import sys
from collections.abc import Callable, Iterator
from copy import deepcopy
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from jsonschema import Draft202012Validator

from hybridid.rigs.emps import EMPSRig
from pipelines.shared import own_code, trust
from pipelines.shared.config import Settings

CONFIG: dict[str, Any] = {
    "case": {"title": "a short carriage"},
    "data": "auto",
    "plant": "hybridid.plants.emps:EMPS",
    "effects": ["viscous", "coulomb", "offset"],
    "parameters": {"M": {"lower": 30.0, "upper": 150.0}},
    "signals": {
        "time": {"column": "t"},
        "inputs": {"force": {"column": "force", "unit": "N", "hold": "zoh"}},
        "outputs": {"position": {"column": "mm", "unit": "m", "scale": 1e-3}},
    },
    "records": {
        "first": {"files": "first.csv", "role": "identification", "run": "identification"},
        "second": {"files": "second.csv", "role": "validation", "run": "validation"},
    },
    "rig": {"path": "hybridid.rigs.emps:EMPSRig", "seed": 0, "duration": 1.2},
    "preprocess": {"steps": []},
    "estimator": {"horizon": 300},
    "fit": {"records": ["identification"]},
    "validate": {
        "records": None,
        "views": ["free_run", "horizon"],
        "horizon": 0.3,
        "initial_state": "estimated",
        "lags": 20,
    },
    "paths": {"data": "data", "outputs": "outputs"},
    "mlflow": {"enabled": True},
}


@dataclass
class Heard:
    """A watcher that remembers."""

    said: list[str] = field(default_factory=list)
    warned: list[str] = field(default_factory=list)
    works: list[str] = field(default_factory=list)

    def say(self, line: str) -> None:
        self.said.append(line)

    def warn(self, line: str) -> None:
        self.warned.append(line)

    def carry_on(self) -> None:
        pass

    def progress(self, work: str, state: str, fraction: float | None) -> None:
        self.works.append(f"{work}: {state}")


@pytest.fixture(scope="session")
def recordings() -> dict[str, str]:
    """The files of both records, by name."""
    texts = {}
    for name, run in (("first.csv", "identification"), ("second.csv", "validation")):
        record = EMPSRig().record(run, duration=1.2)
        columns = np.column_stack([record.time, record.inputs[:, 0], 1e3 * record.outputs[:, 0]])
        rows = "\n".join(",".join(f"{value:.12g}" for value in row) for row in columns)
        texts[name] = f"t,force,mm\n{rows}\n"
    return texts


@pytest.fixture
def data(own_folder: Path, recordings: dict[str, str]) -> Path:
    """The data root, filled."""
    folder = own_folder / "data"
    folder.mkdir()
    for name, text in recordings.items():
        (folder / name).write_text(text)
    return folder


@pytest.fixture
def settings(own_folder: Path, monkeypatch: pytest.MonkeyPatch) -> Callable[..., Settings]:
    """``settings({"estimator.horizon": 100})``: the case with some keys changed."""
    monkeypatch.delenv("HYBRIDID_DATA", raising=False)

    def changed(changes: dict[str, Any] | None = None, **more: Any) -> Settings:
        config = deepcopy(CONFIG)
        for key, value in (changes or {}).items():
            *above, last = key.split(".")
            node = config
            for part in above:
                node = node.setdefault(part, {})
            node[last] = value
        return Settings("short", config, **more)

    return changed


@pytest.fixture(scope="session")
def fits_schema() -> Callable[[Path], None]:
    """``fits_schema(path)`` fails unless a file of results is what its schema in the docs says."""
    schemas = Path(__file__).parents[2] / "docs" / "schemas"

    def check(path: Path) -> None:
        schema = json.loads((schemas / f"{path.stem}.schema.json").read_text())
        Draft202012Validator(schema).validate(json.loads(path.read_text()))

    return check


@pytest.fixture
def nothing_imported(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """No folder of own code yet; afterwards the modules from there are forgotten again."""
    monkeypatch.setattr(own_code, "_folders", [])
    monkeypatch.setattr(trust, "_admitted", set())
    for name in ("path", "path_hooks"):
        monkeypatch.setattr(sys, name, list(getattr(sys, name)))
    before = set(sys.modules)
    yield
    for name in set(sys.modules) - before:
        own = any(Path(place).is_relative_to(f) for place in _files(name) for f in own_code.importable())
        if own:
            del sys.modules[name]
    sys.path_importer_cache.clear()


def _files(name: str) -> list[str]:
    module = sys.modules[name]
    return [*filter(None, [getattr(module, "__file__", None)]), *getattr(module, "__path__", [])]


@pytest.fixture
def heard() -> Heard:
    return Heard()
