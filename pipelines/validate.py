"""``validate``: compares the fitted model and its hybrid with every record, in free run, over horizons, and
under the control law that ran the machine."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from hybridid.advice.horizon import SHORTEST, proposed_horizon
from hybridid.blame import OwnCodeError
from hybridid.controllers.loop import Loop
from hybridid.declarations import Signal
from hybridid.estimators.estimate import Estimate
from hybridid.hybrid import PortHybrid
from hybridid.model import Model
from hybridid.records.checks import MINIMUM_SAMPLES
from hybridid.records.record import Record
from hybridid.records.store import load_record
from hybridid.simulation.simulate import Diverged
from hybridid.simulation.stability import TooStiff
from hybridid.validation import (
    Agreement,
    Metrics,
    Prediction,
    agreement,
    diverged,
    free_run,
    horizon_run,
    in_loop,
    metrics,
    residual_tests,
    synchronised,
    unknown_agreement,
)
from pipelines.shared.config import Settings
from pipelines.shared.controlling import controller_code, controller_section, loop_of
from pipelines.shared.errors import ConfigError
from pipelines.shared.fitted import fit_of, fitted_model, without_own
from pipelines.shared.hybrids import hybrid_of
from pipelines.shared.modelling import groupings_of, model_of, named_code
from pipelines.shared.predictions import HYBRID, LAW, METRICS, RESIDUALS, Tested, write_prediction
from pipelines.shared.prepared import Prepared, prepared_records
from pipelines.shared.sections.stages import ValidateSection
from pipelines.shared.sources import chosen, sources_of
from pipelines.shared.stage import Job, Stage
from pipelines.shared.storage import write_json


@dataclass(frozen=True, eq=False)
class _Candidate:
    """A model to validate: its ``name``, its simulations of a record, the folder for its predictions.
    ``in_loop`` is None where the model cannot stand in a loop: a network behind the outputs."""

    name: str
    free_run: Callable[[Record, str], Prediction]
    horizon_run: Callable[[Record, int], Prediction]
    in_loop: Callable[[Record, Loop, int], Prediction] | None
    folder: Path


def run(job: Job) -> None:
    """Predict every chosen record in every view with the gray box and with the hybrid, if there is one;
    write predictions, ``metrics.json``, ``residuals.json``, and ``law.json`` of a controller."""
    settings = job.settings
    model, estimate = fitted_model(settings, job.tree)
    candidates = _candidates(job, model, estimate)
    rows: list[Metrics] = []
    tests: list[Tested] = []
    laws: list[Agreement] = []
    section, loop = _section(settings), loop_of(settings, model.inputs, model.outputs)
    groups = groupings_of(settings, model)
    for prepared in chosen(prepared_records(job.tree), section.records, "validate.records"):
        record = load_record(prepared.file)
        for line in without_own(groups, record.name, estimate):
            job.watcher.warn(line)
        for candidate in candidates:
            for view in (view for view in section.views if view != "loop"):
                _tell(job, candidate, record, view)
                new_rows, new_tests = _validated(job, candidate, model, record, view)
                rows += new_rows
                tests += new_tests
        if loop is not None and "loop" in section.views:
            new_rows, new_laws = _under_control(job, candidates, model, record, loop)
            rows += new_rows
            laws += new_laws
    write_json(job.folder / METRICS, rows)
    write_json(job.folder / RESIDUALS, tests)
    if laws:
        write_json(job.folder / LAW, laws)


def _tell(job: Job, candidate: _Candidate, record: Record, view: str) -> None:
    what = f"{candidate.name}, record {record.name}, {view.replace('_', ' ')}"
    job.watcher.progress("validate", what, None)


def check(settings: Settings) -> None:
    """Check the sections ``validate`` and ``controller``.

    Raises:
        ConfigError: if a key or value is wrong, or the controller does not fit the plant.
    """
    chosen(sources_of(settings).found, _section(settings).records, "validate.records")
    if controller_section(settings) is not None:
        model = model_of(settings)
        loop_of(settings, model.inputs, model.outputs)


def check_records(settings: Settings, tree: Path) -> None:
    """Check that a horizon holds samples of every record.

    Raises:
        ConfigError: if one does not; the message says which horizon would.
    """
    section = _section(settings)
    if "horizon" not in section.views:
        return
    for record in chosen(prepared_records(tree), section.records, "validate.records"):
        _samples(section, record)


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
            _in_loop(job, model, values, integrator, substeps),
            job.folder,
        )
    ]
    hybrid = hybrid_of(job.tree, model)
    if hybrid is not None:
        inside = hybrid if isinstance(hybrid, PortHybrid) else None
        found.append(
            _Candidate(
                hybrid.name,
                lambda record, start: hybrid.free_run(record, start, integrator),
                lambda record, samples: hybrid.horizon_run(record, samples, integrator),
                None if inside is None else _in_loop(job, inside.model, inside.values, integrator, None),
                job.folder / HYBRID,
            )
        )
    return found


def _in_loop(
    job: Job, model: Model, values: Mapping[str, float], integrator: str, substeps: int | None
) -> Callable[[Record, Loop, int], Prediction]:
    """The simulation of a record under a control law."""
    start = _section(job.settings).initial_state
    return lambda record, loop, samples: in_loop(
        model, values, record, loop, samples, start, integrator, substeps
    )


def _under_control(
    job: Job, candidates: Sequence[_Candidate], model: Model, record: Record, loop: Loop
) -> tuple[list[Metrics], list[Agreement]]:
    """Every model on one record in the loop, if the law is the one that ran the machine there."""
    section = controller_section(job.settings)
    most = section.tolerance if section else math.inf
    shown = (*model.outputs, *loop.controller.commands)
    try:
        loop = synchronised(loop, record)
        laws = agreement(loop, record, most)
    except OwnCodeError:
        raise
    except ValueError as error:  # the record lacks a signal of the law, or is too short
        laws = unknown_agreement(loop, record, most, str(error))
    if not all(law.agrees for law in laws):
        job.watcher.warn(f"not simulated in the loop: {laws[0].remark}")
        return [], list(laws)
    rows: list[Metrics] = []
    for one in candidates:
        if one.in_loop is None:
            job.watcher.warn(f"{one.name} stands behind the outputs, and is not simulated in the loop")
            continue
        _tell(job, one, record, "in the loop")
        rows += _controlled(job, one, record, loop, shown)
    return rows, list(laws)


def _controlled(
    job: Job, candidate: _Candidate, record: Record, loop: Loop, shown: Sequence[Signal]
) -> list[Metrics]:
    assert candidate.in_loop is not None
    samples = max(round(_section(job.settings).horizon / record.dt), MINIMUM_SAMPLES)
    try:
        prediction = candidate.in_loop(record, loop, samples)
    except (Diverged, TooStiff) as error:
        why = str(error) if isinstance(error, Diverged) else f"record {record.name}: {error}"
        job.watcher.warn(why)
        return diverged(record, shown, candidate.name, why, view="loop")
    write_prediction(candidate.folder, prediction, candidate.name, None)
    return metrics(prediction, candidate.name)


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
    return candidate.horizon_run(record, _samples(section, record))


def _samples(section: ValidateSection, record: Record | Prepared) -> int:
    """Samples of a horizon of the record."""
    samples = round(section.horizon / record.dt)
    if samples < SHORTEST:
        proposed = proposed_horizon(record.dt, record.n * record.dt)
        raise ConfigError(
            f"validate.horizon is {section.horizon:g} s: record {record.name} is sampled every "
            f"{record.dt:.6g} s, a horizon needs at least {SHORTEST} samples; "
            f"validate.horizon={proposed:g} is proposed"
        )
    return samples


VALIDATE = Stage(
    "validate",
    ("validate", "controller"),
    ("preprocess", "fit", "residual"),
    run,
    inputs=lambda settings: {**named_code(settings), **controller_code(settings)},
    check=check,
    check_records=check_records,
)
