"""Figures of Chapter 4: the vehicle over the bump."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

from hybridid.plotting.panels import ROW, Panel
from hybridid.plotting.style import Plot
from pipelines.thesis.chapter4 import EXPERIMENT, PITCH, VELOCITY
from pipelines.thesis.figure import Draw, Figure, plot_of
from pipelines.thesis.views import Runs, error_panel, response_panel, scatter_panel, signal_panels

OUTPUTS = {"vertical velocity": VELOCITY, "pitch rate": PITCH}


def _filtered(runs: Runs) -> Plot:
    run = runs[EXPERIMENT]
    record = run.record("identification")
    panels = signal_panels(record, (PITCH, "vertical_acceleration"), run.raw("identification"))
    return plot_of(record, "pitch rate and vertical acceleration before and after the filter", panels)


def _used(runs: Runs) -> Plot:
    record = runs[EXPERIMENT].record("identification")
    shows = "pitch rate and vertical velocity that the models are fitted to"
    return plot_of(record, shows, signal_panels(record, (PITCH, VELOCITY)))


def _each(role: str, shows: str, panel: Callable[..., Panel], columns: int = 1, row: float = ROW) -> Draw:
    """A panel for each output."""

    def draw(runs: Runs) -> Plot:
        run = runs[EXPERIMENT]
        panels = [panel(word, run.both(role, name)) for word, name in OUTPUTS.items()]
        return plot_of(run.record(role), shows, panels, columns, row)

    return draw


def _responses(role: str) -> Draw:
    whole = partial(response_panel, focus=False)
    return _each(role, "data, gray box and hybrid in free run", whole, row=44.0)


_ERRORS = "errors of gray box and hybrid in free run"
_LINE = "models over data, sample by sample; a perfect model lies on the line"


FIGURES = (
    Figure("4.3", "pitch rate and vertical acceleration, recorded and filtered", _filtered),
    Figure("4.4", "pitch rate and vertical velocity that the method uses", _used),
    Figure("4.7", "data, gray box and hybrid", _responses("identification")),
    Figure(
        "4.8",
        "errors of gray box and hybrid",
        _each("identification", _ERRORS, partial(error_panel, focus=False)),
    ),
    Figure("4.9", "data against models", _each("identification", _LINE, scatter_panel, 2, 84.0)),
    Figure(
        "", "data, gray box and hybrid at the held-out speed", _responses("validation"), "vehicle-held-out"
    ),
)
NOT_DRAWN = "Figures 4.1, 4.2, 4.5 and 4.6 are a bump's dimensions, a photograph, a sketch and a diagram."
