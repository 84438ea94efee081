"""``reproduce``: the thesis' experiments run one after another, and its tables beside ours.

An experiment whose results are fresh is reused, so an interrupted run goes on where it stopped.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from pipelines.config import Settings
from pipelines.findings import provenance_of
from pipelines.page import Page, Picture, Section
from pipelines.runner import run_stages
from pipelines.thesis.compare import table_of
from pipelines.thesis.reference import TABLES, MetricOf, ParameterOf, ThesisTable
from pipelines.tracking import tracked
from pipelines.tree import write_text
from pipelines.watch import Watcher

FIGURES = ("comparison", "error", "friction", "raincloud")
"""Endings of the figures' names that the page shows."""


def reproduce(experiments: Mapping[str, Settings], outputs: Path, watcher: Watcher) -> Path:
    """Run every experiment and write ``outputs/thesis/index.html`` and ``index.md``.

    Returns the page's path.
    """
    trees: dict[str, Path] = {}
    for number, (name, settings) in enumerate(experiments.items(), 1):
        watcher.say(f"experiment {number} of {len(experiments)}: {name}")
        with tracked(settings, "run", watcher) as logged:
            outcome = run_stages(settings, "run", watcher)
            logged.finish(outcome)
        trees[name] = outcome.tree
    folder = outputs / "thesis"
    folder.mkdir(parents=True, exist_ok=True)
    page = thesis_page(trees)
    write_text(folder / "index.md", page.markdown(folder))
    write_text(folder / "index.html", page.html())
    return folder / "index.html"


def thesis_page(trees: Mapping[str, Path]) -> Page:
    """The page of all tables whose experiments were run, and their figures."""
    tables = [table for table in TABLES if _experiments(table) <= set(trees)]
    data = sorted({provenance_of(tree) for tree in trees.values()})
    figures = tuple(
        Section(f"Figures of {name}", (f"Data: {provenance_of(tree)}.",), pictures=_pictures(tree))
        for name, tree in trees.items()
    )
    return Page(
        "The thesis, reproduced",
        f"The thesis' tables beside ours. Data here: {' and '.join(data)}; each row says which.",
        (Section("Tables", (_INTERVALS,), tuple(table_of(t, trees) for t in tables)), *figures),
    )


_INTERVALS = "± gives the 95 % interval of an estimate, with autocorrelated residuals allowed for. SI units."


def _experiments(table: ThesisTable) -> set[str]:
    return {e.ours.experiment for e in table.entries if isinstance(e.ours, ParameterOf | MetricOf)}


def _pictures(tree: Path) -> tuple[Picture, ...]:
    files = sorted((tree / "plot").glob("*.svg"))
    return tuple(Picture(f, f.stem.replace(".", ", ")) for f in files if f.stem.rpartition(".")[2] in FIGURES)
