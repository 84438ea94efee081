"""``preprocess``: from a case's files, or its rig, to checked and filtered records in ``preprocess/``."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from hybridid.records.record import Record
from hybridid.records.store import save_record
from hybridid.signals.step import StepError, as_steps
from hybridid.signals.steps import apply_steps, parse_steps
from pipelines.shared import sources
from pipelines.shared.config import Settings
from pipelines.shared.errors import ConfigError
from pipelines.shared.limits import check_demand
from pipelines.shared.modelling import channels_of, given_of, weights_of
from pipelines.shared.prepared import NamedUnit, Prepared
from pipelines.shared.remarks import together
from pipelines.shared.sources import Simulated, Source, sources_of
from pipelines.shared.stage import Job, Stage
from pipelines.shared.storage import write_json

KEYS = (*sources.KEYS, "preprocess", "channels", "plant")


def run(job: Job) -> None:
    """Read every record of the case, apply its own steps and then ``preprocess.steps``, make inputs of its
    ``channels``, of the parameters that it gives and of the weights of its groups, store samples and
    description."""
    rows: list[Prepared] = []
    channels = [signal.name for signal in channels_of(job.settings)]
    units = {signal.name: signal.unit for signal in given_of(job.settings)}
    weights = weights_of(job.settings)
    for source in sources_of(job.settings).found:
        steps = [*source.steps, *_common_steps(job.settings)]
        record = apply_steps(source.record(), steps).with_channels(channels)
        constants = {**source.constants, **weights.get(source.name, {})}
        record = record.with_constants({name: constants[name] for name in units}, units)
        save_record(record, job.folder / f"{source.name}.parquet")
        rows.append(_described(source, record))
    for line in together({row.name: row.warnings for row in rows}):
        job.watcher.warn(line)
    if masked := [row.masked for row in rows if row.masked]:
        within = f"{len(masked)} of {len(rows)} records"
        job.watcher.say(
            f"masked: {sum(masked)} of {sum(row.n for row in rows)} samples, in {within}, do not count"
        )
    write_json(job.folder / "records.json", rows)


def _described(source: Source, record: Record) -> Prepared:
    return Prepared(
        name=source.name,
        role=source.role,
        provenance=record.provenance,
        file=Path("preprocess") / f"{source.name}.parquet",
        source=record.source,
        digest=record.digest,
        n=record.n,
        dt=record.dt,
        inputs=NamedUnit.each(record.input_channels),
        outputs=NamedUnit.each(record.output_channels),
        auxiliary=NamedUnit.each(record.auxiliary_channels),
        warnings=tuple(record.warnings),
        masked=int(np.sum(~record.counts)),
    )


def _common_steps(settings: Settings) -> tuple[Any, ...]:
    """The steps of every record."""
    return as_steps(settings.get("preprocess.steps"), "preprocess.steps")


def check(settings: Settings) -> None:
    """Check that the records can be found and that the filter steps are valid.

    Raises:
        ConfigError: if a name or number in the config is wrong.
        RecordNotFoundError: if a record is not found and the case has no rig to simulate it.
    """
    channels_of(settings)
    given_of(settings)
    found = sources_of(settings).found
    try:
        for source in found:
            parse_steps(source.steps, f"records.{source.name}.steps")
        parse_steps(_common_steps(settings), "preprocess.steps")
    except StepError as error:
        raise ConfigError(str(error)) from error
    for source in found:
        if isinstance(source, Simulated):
            check_demand(source.demand, settings)


def _digests(settings: Settings) -> dict[str, str]:
    """Those of the records, and the weights of their groups."""
    weights = {f"groups of record {name}": repr(own) for name, own in weights_of(settings).items()}
    return sources.digests(settings) | weights


PREPROCESS = Stage("preprocess", KEYS, (), run, inputs=_digests, check=check)
