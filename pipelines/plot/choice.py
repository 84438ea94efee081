"""Whose figures are drawn: those of all records cost minutes where there are many."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from hybridid.naming import listed
from pipelines.shared.config import Settings
from pipelines.shared.predictions import metric_rows
from pipelines.shared.prepared import Prepared
from pipelines.shared.sections.stages import FEW_RECORDS, PlotSection
from pipelines.shared.sources import chosen

RANKS = ("worst", "median", "best")


def drawn_records(settings: Settings, tree: Path, records: Sequence[Prepared]) -> tuple[list[Prepared], str]:
    """The records that ``plot.records`` asks for, and a line about those left out (empty if none is)."""
    wanted = settings.section("plot", PlotSection).records
    if wanted != "auto":
        return chosen(records, None if wanted == "all" else wanted, "plot.records"), ""
    order = [name for name, _ in sorted(errors(tree).items(), key=lambda one: -one[1])]
    if len(records) <= FEW_RECORDS or len(order) < len(RANKS):
        return list(records), ""
    names = dict(zip((order[0], order[len(order) // 2], order[-1]), RANKS, strict=True))
    ranked = listed([f"{name} ({rank})" for name, rank in names.items()])
    line = f"figures of 3 of {len(records)} records, by the validation error: {ranked}"
    return [one for one in records if one.name in names], f"{line}; plot.records=all draws all"


def errors(tree: Path) -> dict[str, float]:
    """The error of each validated record in % of doing nothing, mean over outputs and views, of the model
    that was validated last (the hybrid, if there is one); infinite where it diverged."""
    rows = metric_rows(tree)
    own = [row for row in rows if row.model == rows[-1].model]
    found: dict[str, list[float]] = {}
    for row in own:
        error = 100.0 - row.fit_percent
        found.setdefault(row.record, []).append(error if error == error else float("inf"))
    return {name: sum(each) / len(each) for name, each in found.items()}
