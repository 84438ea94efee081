"""Whose figures are drawn: those of all records cost minutes where there are many."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from hybridid.naming import listed
from pipelines.shared.config import Settings
from pipelines.shared.predictions import metric_rows
from pipelines.shared.prepared import Prepared
from pipelines.shared.sections.stages import FEW_RECORDS, PlotSection
from pipelines.shared.sources import chosen

RANKS = ("median", "best")


@dataclass(frozen=True)
class Choice:
    """The records of which ``all_figures`` are drawn, those ``compared`` with the model and no more, and what
    is ``said`` of the others (empty if each has all figures)."""

    all_figures: list[Prepared]
    compared: list[Prepared]
    said: str = ""


def drawn_records(settings: Settings, tree: Path, records: Sequence[Prepared]) -> Choice:
    """What ``plot.records`` asks for."""
    wanted = settings.section("plot", PlotSection).records
    if wanted != "auto":
        return Choice(chosen(records, None if wanted == "all" else wanted, "plot.records"), [])
    order = [name for name, _ in sorted(errors(tree).items(), key=lambda one: -one[1])]
    if len(records) <= FEW_RECORDS or len(order) <= len(RANKS):
        return Choice(list(records), [])
    worst, *others = order[0], order[len(order) // 2], order[-1]
    ranked = [f"{name} ({rank})" for name, rank in zip(others, RANKS, strict=True)]
    said = (
        f"of {len(records)} records all figures of {worst}, which has the largest validation error, and the "
        f"comparisons of {listed(ranked)}; plot.records=all draws all"
    )
    return Choice(
        [one for one in records if one.name == worst], [one for one in records if one.name in others], said
    )


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
