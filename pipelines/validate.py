"""``validate``: the fitted model against every record, in free run and over horizons."""

from __future__ import annotations

from dataclasses import asdict
from typing import Any

import numpy as np

from hybridid.estimators.estimate import Estimate
from hybridid.model import Model
from hybridid.records.record import Record
from hybridid.records.store import load_record
from hybridid.simulation.simulate import Diverged
from hybridid.validation import VIEWS, Prediction, free_run, horizon_run, metrics, residual_tests
from pipelines.config import Settings
from pipelines.errors import ConfigError, unknown
from pipelines.findings import estimate_of, prepared_records
from pipelines.fitted import load
from pipelines.predictions import RESIDUALS, Tested, write_prediction, write_tests
from pipelines.sources import chosen, sources_of
from pipelines.stage import Job, Stage
from pipelines.storage import write_json

INITIAL_STATES = ("estimated", "measured")
_NO_SCORE = {"mse": None, "rmse": None, "r2": None, "fit_percent": None}


def run(job: Job) -> None:
    """Predict every chosen record in every view; write predictions, ``metrics.json``, ``residuals.json``."""
    settings = job.settings
    rows: list[dict[str, Any]] = []
    tests: list[Tested] = []
    for prepared in chosen(prepared_records(job.tree), settings.get("validate.records"), "validate.records"):
        record = load_record(prepared.file)
        for view in settings["validate.views"]:
            job.watcher.progress("validate", f"record {record.name}, {view.replace('_', ' ')}", None)
            new_rows, new_tests = _validated(job, record, view)
            rows += new_rows
            tests += new_tests
    write_json(job.folder / "metrics.json", rows)
    write_tests(job.folder / RESIDUALS, tests)


def check(settings: Settings) -> None:
    """Whether the section ``validate`` can be carried out.

    Raises:
        ConfigError: if it cannot.
    """
    chosen(sources_of(settings).found, settings.get("validate.records"), "validate.records")
    views = settings.get("validate.views", [])
    if not isinstance(views, list) or not views:
        raise ConfigError(f"validate.views is {views!r}: give a list of {', '.join(VIEWS)}")
    for view in views:
        if view not in VIEWS:
            raise ConfigError(unknown("view in validate.views:", str(view), VIEWS))
    if settings["validate.initial_state"] not in INITIAL_STATES:
        given = str(settings["validate.initial_state"])
        raise ConfigError(unknown("value of validate.initial_state", given, INITIAL_STATES))
    _positive(settings, "validate.horizon", "s")
    _positive(settings, "validate.lags", "samples")


def _validated(job: Job, record: Record, view: str) -> tuple[list[dict[str, Any]], list[Tested]]:
    """One record in one view: its prediction is written, its scores and tests are returned."""
    model, estimate = load(job.tree)
    name = str(estimate_of(job.tree)["model"])
    seconds = float(job.settings["validate.horizon"]) if view == "horizon" else None
    try:
        prediction = _predicted(job.settings, model, estimate, record, seconds)
    except Diverged as error:
        job.watcher.warn(str(error))
        about = {"model": name, "record": record.name, "view": view, "horizon": seconds, "remark": str(error)}
        scores = {**_NO_SCORE, "n": record.n, "provenance": record.provenance}
        return [{**about, "output": y.name, **scores, "unit": y.unit} for y in model.outputs], []
    write_prediction(job.folder, prediction, name, seconds)
    rows = [{**asdict(row), "horizon": seconds} for row in metrics(prediction, name)]
    found = residual_tests(prediction, record, int(job.settings["validate.lags"]))
    return rows, [Tested(name, view, seconds, test) for test in found]


def _predicted(
    settings: Settings, model: Model, estimate: Estimate, record: Record, seconds: float | None
) -> Prediction:
    integrator = estimate.settings.integrator
    if seconds is None:
        return free_run(model, estimate.values, record, settings["validate.initial_state"], integrator)
    samples = round(seconds / record.dt)
    if samples < 2:
        raise ConfigError(
            f"validate.horizon is {seconds:g} s: record {record.name} is sampled every {record.dt:g} s, "
            "a horizon needs 2 samples"
        )
    return horizon_run(model, estimate.values, record, samples, integrator)


def _positive(settings: Settings, key: str, unit: str) -> None:
    value = settings[key]
    if isinstance(value, bool) or not isinstance(value, (int, float)) or not 0 < value < np.inf:
        raise ConfigError(f"{key} is {value!r}: must be a positive number of {unit}")


VALIDATE = Stage(
    "validate", ("validate",), ("preprocess", "fit"), run, check=check, ignores=("plotting", "rigs", "fetch")
)
