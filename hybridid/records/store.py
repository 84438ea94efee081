"""A ``Record`` in one file, bit for bit: how one stage passes records to the next.

The file is Parquet, so that pandas, MATLAB or a plotting tool reads it too: a column ``time``
[s] and one for each channel, under its name. All else (roles, units, holds, provenance) is JSON in
the file's metadata, under ``hybridid``.
"""

from __future__ import annotations

import json
import uuid
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

from hybridid.records.channel import Array, Channel, RecordError
from hybridid.records.masked import Masked, runs
from hybridid.records.record import Record
from hybridid.records.tables import column, read_table, table_of

KEY = b"hybridid"
FORMAT = 1
ROLES = ("input", "output", "auxiliary")


def save_record(record: Record, path: Path | str) -> Path:
    """Write ``record`` to ``path`` (``.parquet``), which is returned. A failed write leaves no file."""
    from pyarrow import parquet

    path = Path(path)
    columns = {"time": record.time, **{c.name: record.signal(c.name) for c in record.channels}}
    description = json.dumps(_description(record), ensure_ascii=False)
    table = table_of(columns).replace_schema_metadata({KEY: description.encode()})
    path.parent.mkdir(parents=True, exist_ok=True)
    temporary = path.with_name(f".{path.name}.{uuid.uuid4().hex}")
    try:
        parquet.write_table(table, temporary)
        temporary.replace(path)
    finally:
        temporary.unlink(missing_ok=True)
    return path


def load_record(path: Path | str) -> Record:
    """The record that ``save_record`` wrote to ``path``.

    Raises:
        RecordError: if there is no such file, or ``save_record`` did not write it.
    """
    import pyarrow as pa

    path = Path(path)
    if not path.is_file():
        raise RecordError(f"{path}: no such file")
    try:
        table = read_table(path)
        description = json.loads((table.schema.metadata or {})[KEY])
    except (pa.ArrowException, OSError, KeyError, json.JSONDecodeError) as wrong:
        raise RecordError(f"{path}: not a record that hybridid wrote") from wrong
    if description.get("format") != FORMAT:
        raise RecordError(
            f"{path}: format {description.get('format')}, this version reads {FORMAT}; make it anew"
        )
    channels = {role: tuple(Channel(**c) for c in description.pop(role)) for role in ROLES}
    del description["format"]
    auxiliary = _matrix(table, channels["auxiliary"])
    masked = tuple(Masked(*stretch) for stretch in description.pop("masked", ()))
    absent = np.zeros((table.num_rows, len(channels["output"])), dtype=bool)
    for output, first, end in description.pop("absent", ()):
        absent[first:end, output] = True
    return Record(
        time=column(table, "time"),
        inputs=_matrix(table, channels["input"]),
        outputs=_matrix(table, channels["output"]),
        auxiliary=auxiliary if channels["auxiliary"] else None,
        input_channels=channels["input"],
        output_channels=channels["output"],
        auxiliary_channels=channels["auxiliary"],
        masked=masked,
        absent=absent,
        **{**description, "warnings": tuple(description["warnings"])},
    )


def _description(record: Record) -> dict[str, Any]:
    roles = zip(
        ROLES, (record.input_channels, record.output_channels, record.auxiliary_channels), strict=True
    )
    return {
        "format": FORMAT,
        "name": record.name,
        "simulated": record.simulated,
        "source": record.source,
        "digest": record.digest,
        "warnings": record.warnings,
        **{role: [asdict(channel) for channel in channels] for role, channels in roles},
        **({"masked": record.masked} if record.masked else {}),
        **({"absent": _stretches(record)} if record.absent is not None else {}),
    }


def _stretches(record: Record) -> list[tuple[int, int, int]]:
    """Output, first and end sample of each stretch of cells that are absent."""
    absent = np.zeros_like(record.outputs, dtype=bool) if record.absent is None else record.absent
    return [
        (output, first, end)
        for output, cells in enumerate(absent.T)
        for first, end in runs(cells)
        if cells[first]
    ]


def _matrix(table: Any, channels: tuple[Channel, ...]) -> Array:
    columns = [column(table, channel.name) for channel in channels]
    return np.column_stack(columns) if columns else np.empty((table.num_rows, 0))
