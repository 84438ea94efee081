"""What holds for each figure: units, provenance, room for every word, small files, no global state."""

from __future__ import annotations

import functools
import itertools
import re
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import matplotlib
import pytest
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.figure import Figure
from matplotlib.text import Text
from matplotlib.transforms import Bbox

from hybridid.plotting.style import DOUBLE_COLUMN, SINGLE_COLUMN, context, save

WIDTHS = (SINGLE_COLUMN, DOUBLE_COLUMN)
UNIT = re.compile(r"\[[^\]]+\]$")
SVG_LIMIT = 500_000  # bytes


def test_every_labelled_axis_carries_its_unit(make, figure_name):
    labels = [label for axes in _all_axes(make(figure_name).figure) for label in _labels(axes)]
    assert len(labels) >= 1
    assert [label for label in labels if not UNIT.search(label.replace("\n", " "))] == []


@pytest.fixture(scope="module")
def laid_out(draw):
    """``laid_out(name, width)``: a figure of simulated data whose layout is done, drawn once."""

    @functools.cache
    def lay_out(name: str, width: float) -> Figure:
        figure = draw(name, simulated=True, width=width).figure
        with context():
            figure.draw_without_rendering()
        return figure

    return lay_out


@pytest.mark.parametrize("width", WIDTHS)
def test_every_word_has_room(laid_out, figure_name, width):
    figure = laid_out(figure_name, width)
    texts = _drawn_texts(figure)
    page = Bbox.from_bounds(0, 0, figure.bbox.width, figure.bbox.height).padded(0.5)
    assert len(texts) > 5
    corners = {name: [page.contains(x, y) for x, y in box.corners()] for name, box in texts}
    assert [name for name, inside in corners.items() if not all(inside)] == []
    pairs = itertools.combinations(texts, 2)
    assert [(a, b) for (a, box), (b, other) in pairs if box.padded(-1).overlaps(other.padded(-1))] == []


@pytest.mark.parametrize("width", WIDTHS)
def test_no_legend_covers_data(laid_out, figure_name, width):
    figure = laid_out(figure_name, width)
    legends = [*figure.legends, *(a.get_legend() for a in figure.axes if a.get_legend())]
    panels = [axes.get_window_extent().padded(-1) for axes in figure.axes]
    boxes = [legend.get_window_extent() for legend in legends]
    assert [box for box in boxes if any(box.overlaps(panel) for panel in panels)] == []
    assert all(box.x0 >= -1 and box.x1 <= figure.bbox.x1 + 1 for box in boxes)


def test_simulated_data_are_marked_and_measured_data_named(make, figure_name):
    simulated, measured = make(figure_name, simulated=True), make(figure_name)
    marks = simulated.figure.findobj(lambda artist: artist.get_gid() == "provenance")
    assert [mark.get_text() for mark in marks] == ["SIMULATED"]
    assert measured.figure.findobj(lambda artist: artist.get_gid() == "provenance") == []
    for plot, word in ((simulated, "simulated"), (measured, "measured")):
        heading = plot.figure.findobj(lambda artist: artist.get_gid() == "heading")[0]
        assert heading.get_text().endswith(f"· {word}")
        assert plot.provenance == word
        assert f"({word})" in plot.caption


def test_the_caption_is_one_sentence(make, figure_name):
    caption = make(figure_name).caption
    assert caption.endswith(".")
    assert caption[0].isupper()
    assert ". " not in caption
    assert len(caption) < 420


@dataclass(frozen=True)
class Written:
    """A figure's name, its files, and matplotlib's settings before it was drawn and after it was saved."""

    name: str
    files: list[Path]
    before: dict[str, Any]
    after: dict[str, Any]


@pytest.fixture(scope="module")
def written(draw, tmp_path_factory):
    """``written(name)``: drawn and saved once."""

    @functools.cache
    def write(name: str) -> Written:
        before = dict(matplotlib.rcParams)
        plot = draw(name, simulated=True)
        files = save(plot, tmp_path_factory.mktemp(name))
        return Written(plot.name, files, before, dict(matplotlib.rcParams))

    return write


def test_three_small_files_come_out(written, figure_name):
    made = written(figure_name)
    assert [path.name for path in made.files] == [f"{made.name}.{kind}" for kind in ("svg", "pdf", "png")]
    assert sorted(made.files[0].parent.iterdir()) == sorted(made.files)
    svg, pdf, png = (path.read_bytes() for path in made.files)
    assert len(svg) < SVG_LIMIT
    assert b"simulated" in svg
    assert b"/Subtype /Type3" not in pdf  # fonts are embedded as TrueType
    assert pdf.startswith(b"%PDF")
    assert png.startswith(b"\x89PNG")


def test_matplotlib_stays_as_it_was(written, figure_name):
    made = written(figure_name)
    assert made.after == made.before


def test_pyplot_is_never_loaded(tmp_path):
    code = (
        "import sys\n"
        "from hybridid.plotting import comparison, error, friction, parameters, raincloud, record\n"
        "from hybridid.plotting import residual_correlation, spectrum, style\n"
        "style.save(style.Plot(style.new_figure(88, 40, 'a', 'measured'), 'a', 'A.'), sys.argv[1])\n"
        "print('matplotlib.pyplot' in sys.modules)\n"
    )
    command = [sys.executable, "-c", code, str(tmp_path)]
    ran = subprocess.run(command, capture_output=True, text=True, check=True)
    assert ran.stdout.strip() == "False"


def _all_axes(figure: Figure) -> list[Axes]:
    """Every axes, those inside others too."""
    return [a for a in figure.findobj(Axes) if a.get_visible()]


def _labels(axes: Axes) -> list[str]:
    return [text for text in (axes.get_xlabel(), axes.get_ylabel()) if text]


def _drawn_texts(figure: Figure) -> list[tuple[str, Bbox]]:
    """Every word that is printed, with its place; ticks outside the limits are not printed."""
    with context():
        renderer = figure.canvas.get_renderer()
        hidden = {id(label) for axis in figure.findobj(Axis) for label in _unprinted(axis)}
        texts = [t for t in figure.findobj(Text) if t.get_visible() and t.get_text().strip()]
        return [(t.get_text(), t.get_window_extent(renderer)) for t in texts if id(t) not in hidden]


def _unprinted(axis: Axis) -> Iterator[Text]:
    printed = {id(tick) for tick in axis._update_ticks()}  # what axis.draw itself asks
    for tick in (*axis.get_major_ticks(), *axis.get_minor_ticks()):
        for label in (tick.label1, tick.label2):
            if id(tick) not in printed or not label.get_visible():
                yield label
