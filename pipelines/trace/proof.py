"""Before and after: the declared and the augmented model, fitted on all fitted records, scored on all."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any

from hybridid.estimators import Estimate, FitSettings, fit
from hybridid.model import Model
from hybridid.records.record import Record
from hybridid.simulation.simulate import Diverged
from hybridid.validation import Prediction, free_run, horizon_run, metrics

BEFORE, AFTER = "gray box", "gray box + effects"
"""What the two models are called wherever a person reads of them."""
WITH_NETWORK = "{} + network"
"""What one of them is called with a learned effort beside it."""
FITTED, HELD_OUT = "fitted", "held out"
_NO_SCORE = {"mse": None, "rmse": None, "r2": None, "fit_percent": None}


@dataclass(frozen=True)
class Ask:
    """How a model is proved: fit settings over the horizon of ``seconds``, the start of a free run."""

    settings: FitSettings
    seconds: float
    initial_state: str


@dataclass(frozen=True)
class Proof:
    """A model with all its parameters refitted, and what it predicts of every record."""

    name: str
    model: Model
    estimate: Estimate
    rows: tuple[dict[str, Any], ...]
    predictions: tuple[Prediction, ...]

    def over_horizons(self, record: str) -> Prediction | None:
        """The prediction of ``record`` over horizons, if there is one."""
        found = [p for p in self.predictions if (p.record, p.view) == (record, "horizon")]
        return found[0] if found else None


def prove(
    name: str,
    model: Model,
    values: Mapping[str, float],
    fitted: Sequence[Record],
    others: Sequence[Record],
    ask: Ask,
) -> Proof:
    """Refit ``model`` from ``values`` on all of ``fitted``; score it on every record, in both views."""
    estimate = fit(model, fitted, ask.settings, start_values=values)
    rows, predictions = scored(name, model, estimate.values, fitted, others, ask)
    return Proof(name, model, estimate, rows, predictions)


def scored(
    name: str,
    model: Model,
    values: Mapping[str, float],
    fitted: Sequence[Record],
    others: Sequence[Record],
    ask: Ask,
) -> tuple[tuple[dict[str, Any], ...], tuple[Prediction, ...]]:
    """Metrics rows and predictions of ``model`` at ``values`` on every record, in both views."""
    rows: list[dict[str, Any]] = []
    predictions: list[Prediction] = []
    for role, records in ((FITTED, fitted), (HELD_OUT, others)):
        for record in records:
            for view in ("free_run", "horizon"):
                row, prediction = _scored(name, model, values, record, view, ask)
                rows += [{**r, "role": role} for r in row]
                predictions += prediction
    return tuple(rows), tuple(predictions)


def _scored(
    name: str, model: Model, values: Mapping[str, float], record: Record, view: str, ask: Ask
) -> tuple[list[dict[str, Any]], list[Prediction]]:
    """Metrics rows of one record in one view; without numbers where the model diverges."""
    horizon = None if view == "free_run" else ask.seconds
    try:
        prediction = _predicted(model, values, record, horizon, ask)
    except Diverged as error:
        about = {"model": name, "record": record.name, "view": view, "horizon": horizon, "remark": str(error)}
        scores = {**_NO_SCORE, "n": record.n, "provenance": record.provenance}
        return [{**about, "output": y.name, **scores, "unit": y.unit} for y in model.outputs], []
    return [{**asdict(row), "horizon": horizon} for row in metrics(prediction, name)], [prediction]


def _predicted(
    model: Model, values: Mapping[str, float], record: Record, horizon: float | None, ask: Ask
) -> Prediction:
    integrator = ask.settings.integrator
    if horizon is None:
        return free_run(model, values, record, ask.initial_state, integrator)
    return horizon_run(model, values, record, round(horizon / record.dt), integrator)
