"""The missing efforts of a trace as files."""

from __future__ import annotations

import json
from pathlib import Path

from hybridid.trace.missing_effort import Missing
from pipelines.shared.storage import write_table

COLUMNS = ("time", "effort", "std", "position", "velocity", "acceleration", "since_reversal")


def write_missing(folder: Path, missing: Missing) -> None:
    """Write ``<record>.<port>.missing_effort.before.parquet`` and ``.after``; the metadata give SI units."""
    for (record, port), efforts in missing.items():
        for when, (model, e) in zip(("before", "after"), efforts.items(), strict=False):
            columns = {name: getattr(e, name) for name in COLUMNS}
            about = {
                "record": record, "port": port, "model": model, "provenance": e.provenance,
                "unit": e.unit, "position_unit": e.position_unit,
            }  # fmt: skip
            notes = {"hybridid": json.dumps(about, ensure_ascii=False)}
            write_table(folder / f"{record}.{port}.missing_effort.{when}.parquet", columns, notes)
