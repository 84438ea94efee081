"""``preprocess``: from the files of a case, or its rig, to checked and filtered records in ``preprocess/``."""

from __future__ import annotations

from typing import Any

from hybridid.records.record import Record
from hybridid.records.store import save_record
from hybridid.signals.steps import apply_steps
from pipelines import sources
from pipelines.sources import Source, sources_of
from pipelines.stage import Job, Stage
from pipelines.storage import write_json

KEYS = (*sources.KEYS, "preprocess")


def run(job: Job) -> None:
    """Read every record of the case, apply ``preprocess.steps``, store it beside what is to know of it."""
    made = sources_of(job.settings)
    for remark in made.remarks:
        job.watcher.warn(remark)
    rows = []
    for source in made.found:
        record = apply_steps(source.record(), job.settings.get("preprocess.steps", []))
        for warning in record.warnings:
            job.watcher.warn(f"record {source.name}: {warning}")
        save_record(record, job.folder / f"{source.name}.parquet")
        rows.append(_row(source, record))
    write_json(job.folder / "records.json", rows)


def _row(source: Source, record: Record) -> dict[str, Any]:
    channels = {
        "inputs": record.input_channels,
        "outputs": record.output_channels,
        "auxiliary": record.auxiliary_channels,
    }
    return {
        "name": source.name,
        "role": source.role,
        "provenance": record.provenance,
        "file": f"preprocess/{source.name}.parquet",
        "source": record.source,
        "digest": record.digest,
        "n": record.n,
        "dt": record.dt,
        **{kind: [{"name": c.name, "unit": c.unit} for c in group] for kind, group in channels.items()},
        "warnings": list(record.warnings),
    }


PREPROCESS = Stage(
    "preprocess", KEYS, (), run, inputs=sources.digests,
    ignores=("plotting", "effects", "plants", "estimators", "validation", "simulation"),
)  # fmt: skip
