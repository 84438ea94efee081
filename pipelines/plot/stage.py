"""``plot``: the figures of a fitted and validated model, each in every format of ``plot.formats``."""

from __future__ import annotations

from pipelines.shared.config import Settings
from pipelines.shared.drawing import drawn
from pipelines.shared.modelling import named_code
from pipelines.shared.sections.stages import PlotSection
from pipelines.shared.stage import Job, Stage


def run(job: Job) -> None:
    """Draw every figure in every format; what cannot be drawn is left out with a warning."""
    from hybridid.plotting.style import save
    from pipelines.plot.figures import figures  # matplotlib takes half a second to import

    kinds = _kinds(job.settings)
    for name, plot in drawn(figures(job), job.watcher):
        save(plot, job.folder, name, kinds)


def check(settings: Settings) -> None:
    """Check the section ``plot``.

    Raises:
        ConfigError: if a format is not allowed.
    """
    _kinds(settings)


def _kinds(settings: Settings) -> tuple[str, ...]:
    return settings.section("plot", PlotSection).formats


PLOT = Stage(
    "plot",
    ("plot",),
    ("preprocess", "fit", "residual", "validate"),
    run,
    inputs=named_code,
    check=check,
)
