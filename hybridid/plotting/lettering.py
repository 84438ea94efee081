"""Text that fits its space: its drawn size is measured, and longer text is cut."""

from __future__ import annotations

from matplotlib.artist import Artist
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.text import Text


def root(artist: Artist) -> Figure:
    """The figure that ``artist`` belongs to."""
    figure = artist.get_figure(root=True)
    assert figure is not None
    return figure


def part_of_width(artist: Artist) -> float:
    """Width of ``artist`` as a part of its figure's."""
    figure = root(artist)
    assert isinstance(figure.canvas, FigureCanvasAgg)
    return float(artist.get_window_extent(figure.canvas.get_renderer()).width / figure.bbox.width)


def cut(words: str, characters: int) -> str:
    """``words`` shortened in the middle, because names often differ in their last part."""
    if len(words) <= characters:
        return words
    tail = (characters - 1) // 2
    return f"{words[: characters - 1 - tail].rstrip()}…{words[len(words) - tail :].lstrip()}"


def shorten(text: Text, room: float, ending: str = "") -> None:
    """Cut ``text``, but not its ``ending``, until both fit into ``room`` of the figure's width."""
    words = text.get_text()
    for characters in range(len(words), 3, -1):
        text.set_text(cut(words, characters) + ending)
        if part_of_width(text) <= room:
            return
