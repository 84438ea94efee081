"""``fit``: from prepared records to ``fit/estimate.json`` and ``fit/model.json``."""

from __future__ import annotations

from hybridid.estimators.fit import fit
from hybridid.records.store import load_record
from pipelines import modelling
from pipelines.findings import records_of
from pipelines.fitted import describe_model
from pipelines.modelling import fit_settings, model_of
from pipelines.sources import chosen
from pipelines.stage import Job, Stage
from pipelines.storage import write_json

KEYS = (*modelling.KEYS, "estimator", "fit.records")


def run(job: Job) -> None:
    """Estimate the model's parameters on the records of ``fit.records``."""
    rows = chosen(records_of(job.tree), job.settings.get("fit.records"), "fit.records")
    records = [load_record(job.tree / row["file"]) for row in rows]
    model = model_of(job.settings)
    estimate = fit(model, records, fit_settings(job.settings), job.watcher.progress)
    about = {
        "case": job.settings.case,
        "records": [row["name"] for row in rows],
        "provenance": " and ".join(sorted({row["provenance"] for row in rows})),
        "effects": [term.name for term in model.terms],
    }
    write_json(job.folder / "estimate.json", {**about, **estimate.to_dict()})
    write_json(job.folder / "model.json", describe_model(job.settings, model))


FIT = Stage(
    "fit", KEYS, ("preprocess",), run, inputs=modelling.own_code, ignores=("plotting", "rigs", "validation")
)
