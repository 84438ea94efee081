"""``fit``: from prepared records to ``fit/estimate.json`` and ``fit/model.json``."""

from __future__ import annotations

from pathlib import Path

from hybridid.estimators.demand import fit_demand
from hybridid.estimators.estimate import Progress
from hybridid.estimators.fit import fit
from hybridid.quality import judge
from hybridid.records.store import load_record
from pipelines.shared import modelling
from pipelines.shared.config import Settings
from pipelines.shared.errors import ConfigError
from pipelines.shared.fitted import Fit, describe_model
from pipelines.shared.limits import check_and_tell, check_demand
from pipelines.shared.modelling import fit_settings, model_of
from pipelines.shared.one_step import check_one_step
from pipelines.shared.prepared import prepared_records
from pipelines.shared.sources import fitted_records, sources_of
from pipelines.shared.stage import Job, Stage
from pipelines.shared.storage import write_json

MODEL_NAME = "gray box"
KEYS = (*modelling.KEYS, "estimator", "fit.records")


def run(job: Job) -> None:
    """Estimate the model's parameters on the records of ``fit.records``, and judge the fit."""
    fitted = fitted_records(prepared_records(job.tree), job.settings)
    records = [load_record(record.file) for record in fitted]
    model = model_of(job.settings)
    check_and_tell(fit_demand(model, records, fit_settings(job.settings)), job.settings, job.watcher)

    def show(report: Progress) -> None:
        state = f"iteration {report.iteration}, cost {report.cost:.6g}"
        job.watcher.progress(report.stage, state, report.fraction)

    estimate = fit(model, records, fit_settings(job.settings), show)
    names = {record.name for record in fitted}
    others = [load_record(one.file) for one in prepared_records(job.tree) if one.name not in names]
    quality = judge(model, records, estimate, others)
    found = Fit(
        case=job.settings.case,
        model=MODEL_NAME,
        records=tuple(record.name for record in fitted),
        provenance=" and ".join(sorted({record.provenance for record in fitted})),
        effects=tuple(term.name for term in model.terms),
        quality=quality,
        estimate=quality.withheld(estimate),
    )
    write_json(job.folder / "estimate.json", found)
    write_json(job.folder / "model.json", describe_model(job.settings, model, found.provenance))


def check(settings: Settings) -> None:
    """Check the config of model, estimator and fitted records, and the code of plant and effects.

    Raises:
        ConfigError: if a name or a value is wrong.
        OwnCodeError: if code of the plant or of an effect fails.
    """
    model = model_of(settings)
    _ = model.f  # asks plant and effects for their equations
    check_demand(fit_demand(model, (), fit_settings(settings)), settings)  # more is known with the records
    sources = sources_of(settings)
    try:
        fitted_records(sources.found, settings)
    except ConfigError as error:  # it may be the record whose file is not there
        missing = "" if sources.simulated else "; ".join(["", *sources.remarks])
        raise ConfigError(f"{error}{missing}") from error


def check_records(settings: Settings, tree: Path) -> None:
    """Check that the fitted records have one sampling time.

    Raises:
        ConfigError: if they have not; the message gives the keys that make it so.
    """
    check_one_step(fitted_records(prepared_records(tree), settings))


FIT = Stage(
    "fit",
    KEYS,
    ("preprocess",),
    run,
    inputs=modelling.named_code,
    check=check,
    check_records=check_records,
)
