"""A fitted model as files, and back: ``load(tree)`` gives what ``fit`` left, ready to simulate."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from hybridid.estimators.estimate import Estimate
from hybridid.model import Model
from pipelines.shared.config import Settings
from pipelines.shared.findings import loaded_estimate
from pipelines.shared.imports import make_importable
from pipelines.shared.modelling import model_of
from pipelines.shared.storage import read_json

MODEL = "fit/model.json"
MAKES_A_MODEL = ("plant", "effects", "parameters")


def describe_model(settings: Settings, model: Model) -> dict[str, Any]:
    """What rebuilds the model, and its equations for a reader."""
    return {
        "case": settings.case,
        "config": {key: settings.get(key) for key in MAKES_A_MODEL},
        "python_folders": [str(folder.resolve()) for folder in settings.folders],
        "states": [{"name": s.name, "unit": s.unit} for s in model.states],
        "inputs": [{"name": s.name, "unit": s.unit} for s in model.inputs],
        "outputs": [{"name": s.name, "unit": s.unit} for s in model.outputs],
        "terms": [
            {"name": t.name, "equation": t.effect.equation, "source": t.effect.source} for t in model.terms
        ],
    }


def load(tree: Path) -> tuple[Model, Estimate]:
    """The fitted model of a run tree and its estimate; ``estimate.values`` are its parameters.

    Raises:
        FileNotFoundError: if the tree holds no fit.
        ConfigError: if the plant or an effect can no longer be imported.
    """
    described = read_json(tree / MODEL)
    make_importable(Path(folder) for folder in described["python_folders"])
    return model_of(Settings(described["case"], described["config"])), loaded_estimate(tree)
