"""Legends outside the data: above their axes or above the figure, which grows to contain them."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence

from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine
from matplotlib.legend import Legend

from hybridid.plotting.lettering import part_of_width, root, shorten
from hybridid.plotting.style import HEADER, MM_PER_INCH

USABLE = 0.86  # part of a figure's width that titles and legends may take above its axes
ONE_ROW = 3.5  # mm, for which the figures leave room
_WHAT = re.compile(r"[,:][^,:]*$")  # the end of "name, free run: RMSE 2.6 mm", kept when the name is cut


def legend_above(axes: Axes, title: str = "") -> None:
    """A left-aligned ``title`` and the legend at its right, above ``axes``.

    For axes as wide as the figure. The legend takes as many columns as fit beside the title.
    """
    handles = axes.get_legend_handles_labels()[0]

    def make(columns: int) -> Legend:
        return axes.legend(handles=handles, loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=columns)

    legend = _fit(make, len(handles), USABLE - part_of_width(axes.set_title(title)))
    _grow(root(axes), max(0.0, _height(legend) - ONE_ROW), keep_for_legend=0.0)


def legend_on_top(figure: Figure, handles: Sequence[Artist]) -> None:
    """One legend for all panels, under the figure's first line."""

    def make(columns: int) -> Legend:
        return figure.legend(handles=handles, loc="upper left", bbox_to_anchor=(0.0, 1.0), ncols=columns)

    legend = _fit(make, len(handles), 0.98)
    legend.set_in_layout(False)
    height = _height(legend)
    _grow(figure, max(0.0, height - ONE_ROW), keep_for_legend=height)
    legend.set_bbox_to_anchor((0.0, 1 - HEADER / (figure.get_figheight() * MM_PER_INCH)), figure.transFigure)


def _fit(make: Callable[[int], Legend], entries: int, room: float) -> Legend:
    """The legend in as many columns as ``room`` holds; names too long for one column are cut."""
    legend = make(max(entries, 1))
    for columns in range(entries - 1, 0, -1):
        if part_of_width(legend) <= room:
            return legend
        legend.remove()
        legend = make(columns)
    longest = max(map(part_of_width, legend.get_texts()), default=0.0)
    allowed = longest - max(0.0, part_of_width(legend) - room)
    for text in legend.get_texts():
        what = _WHAT.search(text.get_text())
        ending = what[0] if what else ""
        text.set_text(text.get_text().removesuffix(ending))
        shorten(text, allowed, ending)
    return legend


def _height(legend: Legend) -> float:
    """In mm."""
    return float(legend.get_window_extent().height / root(legend).dpi * MM_PER_INCH)


def _grow(figure: Figure, by: float, keep_for_legend: float) -> None:
    """Make ``figure`` higher by ``by`` mm; its panels stay below the header and the legend."""
    height = figure.get_figheight() * MM_PER_INCH + by
    figure.set_figheight(height / MM_PER_INCH)
    engine = figure.get_layout_engine()
    assert isinstance(engine, ConstrainedLayoutEngine)
    engine.set(rect=(0.0, 0.0, 1.0, 1 - (HEADER + keep_for_legend) / height))
