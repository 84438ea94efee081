"""The results of ``validate``: predictions as Parquet, one file for each record and view, and residual tests.

Units and provenance are in each file's metadata.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hybridid.validation import Agreement, Metrics, Prediction, ResidualTests
from pipelines.shared.storage import read_as, read_table, write_table

FOLDER = "validate"
HYBRID = "hybrid"
"""Folder, below ``FOLDER``, of the hybrid's predictions; those of the gray box are in ``FOLDER`` itself."""
RESIDUALS = "residuals.json"
METRICS = "metrics.json"
LAW = "law.json"
"""How far a control law with the recorded outputs is from the recorded commands."""


@dataclass(frozen=True)
class Stored:
    """A prediction that ``validate`` wrote; ``horizon`` in s, None for a free run and in the loop."""

    model: str
    horizon: float | None
    prediction: Prediction


@dataclass(frozen=True)
class Tested:
    """Residual tests of one model, record, output and view; ``horizon`` in s, None for a free run."""

    model: str
    view: str
    horizon: float | None
    found: ResidualTests


def write_prediction(folder: Path, prediction: Prediction, model: str, horizon: float | None) -> Path:
    """Write a prediction with the columns ``time`` [s], ``<output>.measured``, ``<output>.predicted`` and
    ``state.<name>``, and of a masked record ``sample``, the samples that count; returns the file's path."""
    columns: dict[str, NDArray[Any]] = {"time": prediction.time}
    for k, name in enumerate(prediction.output_names):
        columns[f"{name}.measured"] = prediction.measured[:, k]
        columns[f"{name}.predicted"] = prediction.predicted[:, k]
    for k, name in enumerate(prediction.state_names):
        columns[f"state.{name}"] = prediction.states[:, k]
    if prediction.rows is not None:
        columns["sample"] = prediction.rows
    words = ("record", "view", "provenance", "output_names", "output_units", "state_names", "breaks")
    about: dict[str, Any] = {word: getattr(prediction, word) for word in words}
    about |= {"initial_states": prediction.initial_states.tolist(), "model": model, "horizon": horizon}
    folder.mkdir(exist_ok=True)
    path = folder / f"{prediction.record}.{prediction.view}.parquet"
    write_table(path, columns, {"hybridid": json.dumps(about, ensure_ascii=False)})
    return path


def read_prediction(path: Path) -> Stored:
    """The prediction that ``write_prediction`` wrote."""
    columns, notes = read_table(path)
    about = json.loads(notes["hybridid"])
    names = {key: tuple(about[key]) for key in ("output_names", "output_units", "state_names")}
    prediction = Prediction(
        record=about["record"],
        view=about["view"],
        provenance=about["provenance"],
        time=columns["time"],
        measured=_matrix(columns, [f"{name}.measured" for name in names["output_names"]]),
        predicted=_matrix(columns, [f"{name}.predicted" for name in names["output_names"]]),
        states=_matrix(columns, [f"state.{name}" for name in names["state_names"]]),
        breaks=tuple(about["breaks"]),
        initial_states=np.array(about["initial_states"], dtype=float),
        rows=columns["sample"].astype(np.int64) if "sample" in columns else None,
        **names,
    )
    return Stored(about["model"], about["horizon"], prediction)


def predictions_in(tree: Path) -> list[Stored]:
    """Every prediction of a run tree, by record and view; the gray box' first, then the hybrid's."""
    gray, hybrid = ((tree / FOLDER / below).glob("*.parquet") for below in ("", HYBRID))
    return [read_prediction(path) for path in (*sorted(gray), *sorted(hybrid))]


def metric_rows(tree: Path) -> list[Metrics]:
    """The scores of a run tree, a row for each model, record, view and output; from ``metrics.json``."""
    return list(read_as(tuple[Metrics, ...], tree / FOLDER / METRICS))


def agreements_in(tree: Path) -> list[Agreement]:
    """How far the control law is from the recorded commands, a row for each record and command; empty
    without a controller."""
    path = tree / FOLDER / LAW
    return list(read_as(tuple[Agreement, ...], path)) if path.exists() else []


def residual_tests_in(tree: Path) -> list[Tested]:
    """The residual tests of a run tree."""
    return list(read_as(tuple[Tested, ...], tree / FOLDER / RESIDUALS))


def _matrix(columns: Mapping[str, NDArray[np.float64]], names: Sequence[str]) -> NDArray[np.float64]:
    return np.column_stack([columns[name] for name in names])
