"""A case made in the test: the EMPS plant over a short record of its rig, written as a measured CSV file."""

from __future__ import annotations

import functools
import json
import shutil
from collections.abc import Callable, Sequence
from copy import deepcopy
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from jsonschema import Draft202012Validator
from scipy.signal import lfilter

from hybridid.rigs.emps import EMPSRig
from pipelines.plot import stage as plot_stage
from pipelines.shared.config import Settings
from pipelines.tracking import store

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


@pytest.fixture(scope="session")
def empty_store(tmp_path_factory: pytest.TempPathFactory) -> Callable[[], Path]:
    """``empty_store()``: a store of MLflow without a run, made once."""
    make = store._make

    @functools.cache
    def made() -> Path:
        file = tmp_path_factory.mktemp("store") / store.STORE
        make(file)
        return file

    return made


@pytest.fixture
def settings(
    own_folder: Path, monkeypatch: pytest.MonkeyPatch, empty_store: Callable[[], Path]
) -> Callable[..., Settings]:
    """``settings({"estimator.horizon": 100})``: the case with some keys changed. A store of MLflow is copied
    where one is wanted: MLflow takes most of a second to make it."""
    monkeypatch.delenv("HYBRIDID_DATA", raising=False)
    monkeypatch.setattr(store, "_make", lambda file: shutil.copyfile(empty_store(), file))

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
def made_before(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, dict[str, Any]]:
    """What ``once`` keeps: a folder for each name, and what was returned."""
    return tmp_path_factory.mktemp("made"), {}


@pytest.fixture
def once(
    own_folder: Path, made_before: tuple[Path, dict[str, Any]]
) -> Callable[[str, Callable[[], Any]], Any]:
    """``once("validated", make)``: what ``make()`` returns and leaves in this folder. The first test that
    asks makes it, the others get a copy."""
    kept, results = made_before

    def made(name: str, make: Callable[[], Any]) -> Any:
        if name in results:
            shutil.copytree(kept / name, own_folder, symlinks=True, dirs_exist_ok=True)
        else:
            there = {path.name for path in own_folder.iterdir()}
            results[name] = make()
            shutil.copytree(
                own_folder,
                kept / name,
                symlinks=True,
                ignore=lambda at, names: there if Path(at) == own_folder else (),
            )
        return deepcopy(results[name])

    return made


@pytest.fixture
def draw_only(monkeypatch: pytest.MonkeyPatch) -> Callable[..., None]:
    """``draw_only("parameters")``: of the figures that ``plot`` chooses, these are drawn; of the others,
    which take their time, empty files are left."""
    real = plot_stage._written
    monkeypatch.setattr(plot_stage, "core_count", lambda: 1)  # others would not know

    def chosen(*names: str) -> None:
        def written(name: str, draw: Callable, folder: Path, kinds: Sequence[str]) -> str:
            if name in names:
                return real(name, draw, folder, kinds)
            for kind in kinds:
                (folder / f"{name}.{kind}").touch()
            return ""

        monkeypatch.setattr(plot_stage, "_written", written)

    return chosen


@pytest.fixture
def narx_grid(data: Path) -> dict[str, Any]:
    """The section ``residual`` of a small grid of NARX networks: two depths, two widths, two seeds.

    So that there is something to learn, the sensor adds up to 1 mm that follows the force with a lag.
    """
    for file in data.iterdir():
        time, force, mm = np.loadtxt(file, delimiter=",", skiprows=1).T
        bent = mm + lfilter([0.0, 0.2], [1.0, -0.8], np.tanh(force / 30))
        columns = np.column_stack([time, force, bent])
        np.savetxt(file, columns, delimiter=",", fmt="%.12g", header="t,force,mm", comments="")
    return {
        "kind": "narx",
        "orders": {"error": 2, "inputs": 1, "gray": 1},
        "depth": [1, 2],
        "width": [4, 6],
        "seeds": [0, 1],
        "every": 5,
        "horizons": [1, 10],
        "epochs": 8,
        "patience": 8,
        "batch": 64,
        "learning_rate": 2.0e-2,
    }


@pytest.fixture(scope="session")
def fits_schema() -> Callable[[Path], None]:
    """``fits_schema(path)`` fails unless a file of results is what its schema in the docs says."""
    schemas = Path(__file__).parents[2] / "docs" / "schemas"

    def check(path: Path) -> None:
        schema = json.loads((schemas / f"{path.stem}.schema.json").read_text())
        Draft202012Validator(schema).validate(json.loads(path.read_text()))

    return check


@pytest.fixture
def heard() -> Heard:
    return Heard()
