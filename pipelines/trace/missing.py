"""The missing efforts and flows of a trace as files."""

from __future__ import annotations

import json
from pathlib import Path

from hybridid.trace.missing_effort import Missing
from pipelines.shared.storage import write_table


def write_missing(folder: Path, missing: Missing) -> None:
    """Write ``<record>.<port>.missing_effort.before.parquet`` and ``.after``; the metadata give SI units."""
    for (record, port), efforts in missing.items():
        for when, (model, e) in zip(("before", "after"), efforts.items(), strict=False):
            motion = {name.replace(" ", "_"): values for name, (values, _) in e.motion.items()}
            columns = {"time": e.time, e.kind: e.effort, "std": e.std, **motion}
            about = {
                "record": record, "port": port, "model": model, "provenance": e.provenance,
                "unit": e.unit, "units": {name: unit for name, (_, unit) in e.motion.items()},
            }  # fmt: skip
            notes = {"hybridid": json.dumps(about, ensure_ascii=False)}
            write_table(folder / f"{record}.{port}.missing_effort.{when}.parquet", columns, notes)
