"""The efforts that models lack, by record and port, and their files."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from hybridid.records.record import Record
from hybridid.trace.mapper import Mapper
from hybridid.trace.missing_effort import MissingEffort, missing_effort
from hybridid.trace.search import Report
from pipelines.shared.storage import write_table
from pipelines.trace.proof import Proof

Missing = dict[tuple[str, str], dict[str, MissingEffort]]
"""By record and port; within, by model."""


@dataclass(frozen=True)
class Failure:
    """Why an effort could not be estimated."""

    what: str


def missing_efforts(
    proofs: Sequence[Proof],
    records: Sequence[Record],
    ports: Sequence[str],
    mapper: Mapper,
    report: Report,
) -> tuple[Missing, list[str]]:
    """What each proved model lacks at each of ``ports`` on every record, and in words what failed."""
    places = [(proof, record, port) for record in records for port in ports for proof in proofs]
    found: Missing = {}
    failures: list[str] = []
    for done, ((proof, record, port), one) in enumerate(zip(places, mapper(_lack, places), strict=True), 1):
        report("missing effort", done, len(places), f"{record.name}, {port}")
        if isinstance(one, Failure):
            failures.append(f"missing effort at {port} on {record.name}, {proof.name}: {one.what}")
        else:
            found.setdefault((record.name, port), {})[proof.name] = one
    return found, failures


def _lack(proof: Proof, record: Record, port: str) -> MissingEffort | Failure:
    try:
        return missing_effort(proof.model, proof.estimate.values, record, port)
    except (ValueError, ArithmeticError, np.linalg.LinAlgError) as error:
        return Failure(str(error))


def write_missing(folder: Path, missing: Mapping[tuple[str, str], Mapping[str, MissingEffort]]) -> None:
    """``<record>.<port>.missing_effort.before.parquet``, ``.after``: SI units, named in its notes."""
    for (record, port), efforts in missing.items():
        for when, (model, e) in zip(("before", "after"), efforts.items(), strict=False):
            columns = {
                name: getattr(e, name)
                for name in (
                    "time", "effort", "std", "position", "velocity", "acceleration", "since_reversal",
                )
            }  # fmt: skip
            about = {
                "record": record, "port": port, "model": model, "provenance": e.provenance,
                "unit": e.unit, "position_unit": e.position_unit,
            }  # fmt: skip
            notes = {"hybridid": json.dumps(about, ensure_ascii=False)}
            write_table(folder / f"{record}.{port}.missing_effort.{when}.parquet", columns, notes)
