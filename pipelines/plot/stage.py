"""``plot``: the figures of a fitted and validated model, each in every format of ``plot.formats``."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from pipelines.plot.choice import drawn_records
from pipelines.shared.config import Settings
from pipelines.shared.drawing import drawn_one, fresh_garbage_alone
from pipelines.shared.modelling import named_code
from pipelines.shared.pool import core_count, mapper_of
from pipelines.shared.prepared import prepared_records
from pipelines.shared.sections.stages import PlotSection
from pipelines.shared.sources import chosen, sources_of
from pipelines.shared.stage import Job, Stage

if TYPE_CHECKING:
    from hybridid.plotting.style import Plot

WORTH_A_PROCESS = 12
"""Figures that take four times as long to draw as a further process takes to import matplotlib."""


def run(job: Job) -> None:
    """Draw the figures of the chosen records, many side by side; of each that cannot be drawn, warn."""
    from pipelines.plot.figures import figures  # matplotlib takes a quarter of a second to import

    choice = drawn_records(job.settings, job.tree, prepared_records(job.tree))
    if choice.said:
        job.watcher.say(f"plot: {choice.said}")
    asked = list(figures(job, choice))
    with mapper_of(_processes(job.settings, len(asked))) as mapper, fresh_garbage_alone():
        given = [(name, draw, job.folder, _section(job.settings).formats) for name, draw in asked]
        for k, (name, trouble) in enumerate(zip(dict(asked), mapper(_written, given), strict=True), 1):
            job.watcher.progress("plot", f"{k} of {len(asked)}, {name}", k / len(asked))
            if trouble:
                job.watcher.warn(trouble)


def _processes(settings: Settings, figures: int) -> int:
    """In how many processes so many figures are drawn."""
    return 1 if settings.in_sweep else max(1, min(core_count(), figures // WORTH_A_PROCESS))


def _written(name: str, draw: Callable[[], Plot], folder: Path, kinds: Sequence[str]) -> str:
    """Draw one figure and write its files; what is wrong, if it cannot be drawn."""
    from hybridid.plotting.style import save

    plot, trouble = drawn_one(name, draw)
    if plot is not None:
        save(plot, folder, name, kinds)
    return trouble


def check(settings: Settings) -> None:
    """Check the section ``plot``.

    Raises:
        ConfigError: if a format is not allowed, or a name matches no record.
    """
    wanted = _section(settings).records
    if not isinstance(wanted, str):
        chosen(sources_of(settings).found, wanted, "plot.records")


def _section(settings: Settings) -> PlotSection:
    return settings.section("plot", PlotSection)


PLOT = Stage(
    "plot",
    ("plot",),
    ("preprocess", "fit", "residual", "validate"),
    run,
    inputs=named_code,
    check=check,
)
