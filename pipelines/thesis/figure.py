"""A figure of the thesis: its number, what it shows, and how ours is drawn."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from hybridid.plotting.panels import ROW, Panel, panels_plot
from hybridid.plotting.style import Plot
from hybridid.records.record import Record
from pipelines.thesis.views import Runs

Draw = Callable[[Runs], Plot]


@dataclass(frozen=True)
class Figure:
    """``number`` as in the thesis ("" if it has none); ``shows`` says what is drawn.

    ``draw`` raises ``Missing`` if the results do not exist.
    """

    number: str
    shows: str
    draw: Draw
    file: str = ""

    @property
    def stem(self) -> str:
        """The name of its file."""
        return self.file or f"figure-{self.number}"

    @property
    def title(self) -> str:
        """The figure's heading, with its number in the thesis if it has one."""
        return f"Figure {self.number}: {self.shows}" if self.number else f"Not in the thesis: {self.shows}"


def plot_of(record: Record, shows: str, panels: Sequence[Panel], columns: int = 1, row: float = ROW) -> Plot:
    """Panels of one record; ``shows`` is the caption in lower case, without provenance."""
    caption = f"{shows[0].upper()}{shows[1:]} ({record.provenance})."
    return panels_plot("thesis", f"{record.name} · {shows}", panels, caption, record.provenance, columns, row)
