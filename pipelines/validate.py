"""``validate``: compares the fitted model and its hybrid with every record, in free run and over horizons."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from hybridid.estimators.estimate import Estimate
from hybridid.model import Model
from hybridid.records.record import Record
from hybridid.records.store import load_record
from hybridid.simulation.simulate import Diverged
from hybridid.simulation.stability import TooStiff
from hybridid.validation import Metrics, Prediction, diverged, free_run, horizon_run, metrics, residual_tests
from pipelines.shared.config import Settings
from pipelines.shared.errors import ConfigError
from pipelines.shared.fitted import fit_of, fitted_model, without_own
from pipelines.shared.hybrids import hybrid_of
from pipelines.shared.modelling import groupings_of, named_code
from pipelines.shared.predictions import HYBRID, RESIDUALS, Tested, write_prediction
from pipelines.shared.prepared import prepared_records
from pipelines.shared.sections.stages import ValidateSection
from pipelines.shared.sources import chosen, sources_of
from pipelines.shared.stage import Job, Stage
from pipelines.shared.storage import write_json


@dataclass(frozen=True, eq=False)
class _Candidate:
    """A model to validate: its ``name``, its two simulations of a record, the folder for its predictions."""

    name: str
    free_run: Callable[[Record, str], Prediction]
    horizon_run: Callable[[Record, int], Prediction]
    folder: Path


def run(job: Job) -> None:
    """Predict every chosen record in every view with the gray box and with the hybrid, if there is one;
    write predictions, ``metrics.json``, ``residuals.json``."""
    settings = job.settings
    model, estimate = fitted_model(settings, job.tree)
    candidates = _candidates(job, model, estimate)
    rows: list[Metrics] = []
    tests: list[Tested] = []
    section = _section(settings)
    groups = groupings_of(settings, model)
    for prepared in chosen(prepared_records(job.tree), section.records, "validate.records"):
        record = load_record(prepared.file)
        for line in without_own(groups, record.name, estimate):
            job.watcher.warn(line)
        for candidate in candidates:
            for view in section.views:
                what = f"{candidate.name}, record {record.name}, {view.replace('_', ' ')}"
                job.watcher.progress("validate", what, None)
                new_rows, new_tests = _validated(job, candidate, model, record, view)
                rows += new_rows
                tests += new_tests
    write_json(job.folder / "metrics.json", rows)
    write_json(job.folder / RESIDUALS, tests)


def check(settings: Settings) -> None:
    """Check the section ``validate``.

    Raises:
        ConfigError: if a key or value is wrong.
    """
    chosen(sources_of(settings).found, _section(settings).records, "validate.records")


def _section(settings: Settings) -> ValidateSection:
    return settings.section("validate", ValidateSection)


def _candidates(job: Job, model: Model, estimate: Estimate) -> list[_Candidate]:
    """The gray box, then the hybrid around it."""
    values, integrator, substeps = estimate.values, estimate.settings.integrator, estimate.substeps
    found = [
        _Candidate(
            fit_of(job.tree).model,
            lambda record, start: free_run(model, values, record, start, integrator, substeps),
            lambda record, samples: horizon_run(model, values, record, samples, integrator, substeps),
            job.folder,
        )
    ]
    hybrid = hybrid_of(job.tree, model)
    if hybrid is not None:
        found.append(
            _Candidate(
                hybrid.name,
                lambda record, start: hybrid.free_run(record, start, integrator),
                lambda record, samples: hybrid.horizon_run(record, samples, integrator),
                job.folder / HYBRID,
            )
        )
    return found


def _validated(
    job: Job, candidate: _Candidate, model: Model, record: Record, view: str
) -> tuple[list[Metrics], list[Tested]]:
    """One model on one record in one view: its prediction is written, its scores and tests are returned."""
    name = candidate.name
    section = _section(job.settings)
    seconds = section.horizon if view == "horizon" else None
    try:
        prediction = _predicted(section, candidate, record, seconds)
    except (Diverged, TooStiff) as error:
        why = str(error) if isinstance(error, Diverged) else f"record {record.name}: {error}"
        job.watcher.warn(why)
        return diverged(record, model.outputs, name, why, seconds), []
    write_prediction(candidate.folder, prediction, name, seconds)
    found = residual_tests(prediction, record, section.lags)
    return metrics(prediction, name, seconds), [Tested(name, view, seconds, test) for test in found]


def _predicted(
    section: ValidateSection, candidate: _Candidate, record: Record, seconds: float | None
) -> Prediction:
    if seconds is None:
        return candidate.free_run(record, section.initial_state)
    samples = round(seconds / record.dt)
    if samples < 2:
        raise ConfigError(
            f"validate.horizon is {seconds:g} s: record {record.name} is sampled every {record.dt:g} s, "
            "a horizon needs at least 2 samples"
        )
    return candidate.horizon_run(record, samples)


VALIDATE = Stage(
    "validate",
    ("validate",),
    ("preprocess", "fit", "residual"),
    run,
    inputs=named_code,
    check=check,
)
