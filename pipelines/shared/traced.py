"""``trace.json``: the result of a trace, and the commands that use its model."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

from hybridid.trace.results.result import Trace
from pipelines.shared.storage import read_as

TRACE = "trace/trace.json"
"""Of the newest trace in a run tree. Those with other options lie in ``traces``."""


@dataclass(frozen=True)
class TraceFile:
    """A trace of a ``case`` in parallel ``processes``, and the ``commands`` to go on with: one that gives
    each recording values of its own, if they disagree, then two that fit the last model. Of the
    ``further_traces`` each asks what a caution advises."""

    case: str
    processes: int
    fitted_records: tuple[str, ...]
    commands: tuple[str, ...]
    found: Trace = field(metadata={"inline": True})
    further_traces: tuple[str, ...] = ()


def trace_of(tree: Path, folder: Path | None = None) -> TraceFile:
    """The newest trace of a run tree, or the one in ``folder``; models and time series are not stored."""
    return read_as(TraceFile, tree / TRACE if folder is None else folder / "trace.json")
