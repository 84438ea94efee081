"""``trace/trace.json``: what a trace found, and the command that found it."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

from hybridid.trace.result import Trace
from pipelines.shared.storage import read_as

TRACE = "trace/trace.json"


@dataclass(frozen=True)
class TraceFile:
    """A trace of a ``case`` on so many ``processes``, and the ``commands`` that go on with its model."""

    case: str
    processes: int
    fitted_records: tuple[str, ...]
    commands: tuple[str, ...]
    found: Trace = field(metadata={"inline": True})


def trace_of(tree: Path) -> TraceFile:
    """``trace/trace.json`` of a run tree; without the evidence, which is not stored."""
    return read_as(TraceFile, tree / TRACE)
