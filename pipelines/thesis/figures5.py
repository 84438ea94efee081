"""Figures of Chapter 5: the eSEA with four frictions."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from hybridid.plotting.panels import Panel
from hybridid.plotting.series import Response
from hybridid.plotting.style import Plot
from pipelines.thesis.chapter5 import FRICTIONS, OUTPUT
from pipelines.thesis.figure import Draw, Figure, plot_of
from pipelines.thesis.look_up import Missing
from pipelines.thesis.views import (
    Runs,
    error_panel,
    response_panel,
    signal_panels,
    spectra_of,
    spectrum_panel,
)

SIGNALS = ("torque", OUTPUT)


def _excitation(role: str) -> Draw:
    def draw(runs: Runs) -> Plot:
        record = runs.first(FRICTIONS.values()).record(role)
        pairs = zip(signal_panels(record, SIGNALS), spectra_of(record, SIGNALS), strict=True)
        panels = [panel for pair in pairs for panel in pair]
        return plot_of(record, "input and output, and their spectra", panels, columns=2, row=40.0)

    return draw


def _each(
    role: str,
    shows: str,
    panel: Callable[[str, Mapping[str, Response]], Panel],
    hybrid: bool = True,
    columns: int = 1,
) -> Draw:
    """A panel for each friction; without the hybrid, the gray box alone.

    A friction without results is left out and the caption says so; the others are drawn all the same.
    """

    def draw(runs: Runs) -> Plot:
        run = runs.first(FRICTIONS.values())
        panels, without = [], []
        for friction, experiment in FRICTIONS.items():
            try:
                shown = runs[experiment].both(role, OUTPUT)
            except Missing as reason:
                without.append(f"{friction}: {reason}")
                continue
            kept = shown if hybrid else {"gray box": shown["gray box"]}
            panels.append(panel(friction, kept))
        if not panels:
            raise Missing(without[0].partition(": ")[2])
        left_out = f"; left out: {'; '.join(without)}" if without else ""
        return plot_of(run.record(role), shows + left_out, panels, columns)

    return draw


def _network(title: str, shown: Mapping[str, Response]) -> Panel:
    return error_panel(title, shown, network=True)


_GRAY, _HYBRID = "data and gray box in free run", "data, gray box and hybrid in free run"
_NETWORK = "error of the gray box, and the network's prediction of it in free run"
_SPECTRUM, _SPECTRA = "spectra of data and gray box", "spectra of data, gray box and hybrid"


def _of(role: str, first: int) -> tuple[Figure, ...]:
    """The five figures that the thesis shows of each record, from ``5.<first>`` on."""
    where = f"{role} record"
    return (
        Figure(f"5.{first}", f"{_GRAY}, {where}", _each(role, _GRAY, response_panel, hybrid=False)),
        Figure(
            f"5.{first + 1}", f"{_SPECTRUM}, {where}",
            _each(role, _SPECTRUM, spectrum_panel, hybrid=False, columns=2),
        ),
        Figure(f"5.{first + 2}", f"{_NETWORK}, {where}", _each(role, _NETWORK, _network)),
        Figure(f"5.{first + 3}", f"{_HYBRID}, {where}", _each(role, _HYBRID, response_panel)),
        Figure(f"5.{first + 4}", f"{_SPECTRA}, {where}", _each(role, _SPECTRA, spectrum_panel, columns=2)),
    )  # fmt: skip


FIGURES = (
    Figure(
        "5.3",
        "input and output of the identification record, and their spectra",
        _excitation("identification"),
    ),
    Figure("5.4", "input and output of the validation record, and their spectra", _excitation("validation")),
    *_of("identification", 7),
    *_of("validation", 12),
)
NOT_DRAWN = "Figures 5.1, 5.2, 5.5 and 5.6 are photographs, a flowchart, a sketch and a diagram."
