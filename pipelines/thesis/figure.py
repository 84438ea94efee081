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

    ``draw`` raises ``Missing`` where the results are not there.
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
        return f"Figure {self.number}: {self.shows}" if self.number else f"Not in the thesis: {self.shows}"


def plot_of(record: Record, said: str, panels: Sequence[Panel], columns: int = 1, row: float = ROW) -> Plot:
    """Panels of one record; ``said`` is the caption without its first capital and its end."""
    caption = f"{said[0].upper()}{said[1:]} ({record.provenance})."
    return panels_plot("thesis", f"{record.name} · {said}", panels, caption, record.provenance, columns, row)
