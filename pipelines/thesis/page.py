"""The page of the reproduced thesis: the experiments, then the tables and figures of each chapter."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from hybridid.plotting.series import PlotError
from hybridid.plotting.style import save
from pipelines.shared.page import Page, Picture, Section, Table
from pipelines.shared.prepared import provenance_of
from pipelines.shared.watch import Watcher
from pipelines.thesis import chapter4, chapter5, chapter6, figures4, figures5, figures6
from pipelines.thesis.choice import choices
from pipelines.thesis.figure import Figure
from pipelines.thesis.look_up import Failed, Missing, NotRun
from pipelines.thesis.reference import ThesisTable, experiments_of
from pipelines.thesis.tables import table_of
from pipelines.thesis.views import Runs

KIND = "svg"


@dataclass(frozen=True)
class Chapter:
    """A chapter's tables and figures; ``not_drawn`` lists the figures that are not drawn and why."""

    number: int
    title: str
    tables: tuple[ThesisTable, ...]
    figures: tuple[Figure, ...]
    not_drawn: str

    @property
    def experiments(self) -> set[str]:
        """The experiments that the chapter's tables need."""
        return {name for table in self.tables for name in experiments_of(table)}


CHAPTERS = (
    Chapter(4, "the vehicle over a bump", chapter4.TABLES, figures4.FIGURES, figures4.NOT_DRAWN),
    Chapter(5, "the elastic joint (eSEA)", chapter5.TABLES, figures5.FIGURES, figures5.NOT_DRAWN),
    Chapter(6, "the positioning system (EMPS)", chapter6.TABLES, figures6.FIGURES, figures6.NOT_DRAWN),
)
_RIG = (
    "The thesis' recordings of this machine are not public: a virtual rig repeats its experiment. Our "
    "numbers are simulated: they show how the method behaves, not how the thesis' machine behaves."
)
_STANDS_IN = "The measured records were not used: all numbers are simulated by the virtual rig."
_READ = (
    "± gives the 95 % interval of an estimate; it allows for autocorrelated residuals. Units are SI. Scores "
    "are of free runs over the whole record unless a table says otherwise."
)


def drawn(runs: Runs, folder: Path, watcher: Watcher) -> dict[str, str]:
    """Draw into ``folder`` the figures of every chapter of which an experiment was requested.

    Returns the caption of each figure by its stem, or the reason why it was not drawn.
    """
    captions = {}
    for chapter in _asked(runs):
        for figure in chapter.figures:
            watcher.progress("figures", figure.title, None)
            try:
                plot = figure.draw(runs)
            except (Missing, PlotError) as reason:
                captions[figure.stem] = str(reason)
                if not isinstance(reason, NotRun):
                    watcher.warn(f"{figure.title}: not drawn, {reason}")
                continue
            save(plot, folder, figure.stem, kinds=(KIND,))
            captions[figure.stem] = plot.caption
    return captions


def thesis_page(runs: Runs, captions: Mapping[str, str], figures: Path, seconds: Mapping[str, float]) -> Page:
    """The page with all chapters of which an experiment was requested; ``figures`` is the folder of
    ``drawn``."""
    chapters = [_chapter(chapter, runs, captions, figures) for chapter in _asked(runs)]
    data = _data(runs, set(runs.outcomes))
    return Page(
        "The thesis, reproduced",
        f"Tables and figures of Chapters 4 to 6 beside ours. Data: {data}, as stated in each row and figure.",
        (_what_was_run(runs, seconds), *chapters),
    )


def _asked(runs: Runs) -> list[Chapter]:
    return [chapter for chapter in CHAPTERS if chapter.experiments & set(runs.outcomes)]


def _what_was_run(runs: Runs, seconds: Mapping[str, float]) -> Section:
    rows = []
    for name, outcome in runs.outcomes.items():
        failed = isinstance(outcome, Failed)
        result = f"failed: {outcome.reason}" if isinstance(outcome, Failed) else "done"
        took = "" if failed else f"{seconds[name]:.0f} s"
        rows.append((name, runs.experiments[name].case, _data(runs, {name}), took, result))
    header = ("experiment", "case", "data", "this time", "result")
    note = (
        "Fresh results were reused and took no time. hybridid run experiment=NAME runs one experiment alone."
    )
    table = Table("Experiments", header, tuple(rows), (note,), words=(0, 1, 2, 4))
    return Section("What was run", (_READ,), (table,))


def _chapter(chapter: Chapter, runs: Runs, captions: Mapping[str, str], figures: Path) -> Section:
    own = chapter.experiments & set(runs.outcomes)
    data = _data(runs, own)
    about_data = [f"Data: {data}."]
    if "simulated" in data:
        about_data.append(_STANDS_IN if chapter.number == 6 else _RIG)
    there = [figure for figure in chapter.figures if _file(figure, figures).exists()]
    missing: dict[str, list[str]] = {}
    for figure in chapter.figures:
        if figure not in there:
            missing.setdefault(captions[figure.stem], []).append(figure.number or figure.shows)
    not_drawn = [f"Figures not drawn ({reason}): {', '.join(which)}." for reason, which in missing.items()]
    pictures = [
        Picture(_file(figure, figures), f"{figure.title}. {captions[figure.stem]}") for figure in there
    ]
    tables = tuple(table_of(table, runs.outcomes) for table in chapter.tables)
    return Section(
        f"Chapter {chapter.number}: {chapter.title}",
        (*about_data, *choices(chapter.number, runs.outcomes), *not_drawn, chapter.not_drawn),
        tables,
        tuple(pictures),
    )


def _file(figure: Figure, folder: Path) -> Path:
    return folder / f"{figure.stem}.{KIND}"


def _data(runs: Runs, names: set[str]) -> str:
    """Provenance of the experiments' data: ``measured``, ``simulated``, or both."""
    trees = [runs.outcomes[name] for name in names]
    kinds = {provenance_of(tree) for tree in trees if isinstance(tree, Path)}
    return " and ".join(sorted(kinds)) or "none, because no experiment has results"
