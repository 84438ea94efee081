"""One style for every figure: sizes, fonts, the provenance mark, and the files.

Nothing here touches pyplot: figures are plain ``matplotlib.figure.Figure`` objects, and
matplotlib's settings are changed only while one is drawn or written.
"""

from __future__ import annotations

import functools
import os
import re
import tempfile
from collections.abc import Callable, Iterator, Sequence
from contextlib import AbstractContextManager, contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ParamSpec

import matplotlib
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine
from matplotlib.transforms import ScaledTranslation

from hybridid.plotting.lettering import part_of_width, shorten
from hybridid.plotting.looks import GRID_GREY, INK, KINDS, SOFT_INK, VERMILION

SINGLE_COLUMN = 88.0  # mm, one column of a two-column page
DOUBLE_COLUMN = 180.0  # mm, both columns
PNG_DPI = 200
HEADER = 5.5  # mm, the first line: what is shown, and its provenance
MARGIN = 1.5  # mm
MM_PER_INCH = 25.4

_RC: dict[str, Any] = {
    "font.family": "sans-serif",
    "font.sans-serif": ["DejaVu Sans"],  # part of matplotlib: the same figure on every machine
    "mathtext.fontset": "dejavusans",
    "font.size": 7.0,
    "axes.labelsize": 7.0,
    "axes.titlesize": 7.0,
    "axes.titlelocation": "left",
    "axes.titlepad": 4.0,
    "axes.titley": 1.0,  # no ticks above the axes: nobody need measure them to place a title
    "legend.fontsize": 6.5,
    "xtick.labelsize": 6.5,
    "ytick.labelsize": 6.5,
    "text.color": INK,
    "axes.labelcolor": INK,
    "axes.edgecolor": SOFT_INK,
    "xtick.color": SOFT_INK,
    "ytick.color": SOFT_INK,
    "xtick.labelcolor": INK,
    "ytick.labelcolor": INK,
    "axes.linewidth": 0.5,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "axes.axisbelow": True,
    "grid.color": GRID_GREY,
    "grid.linewidth": 0.4,
    "xtick.major.width": 0.5,
    "ytick.major.width": 0.5,
    "xtick.major.size": 2.5,
    "ytick.major.size": 2.5,
    "xtick.minor.size": 1.5,
    "ytick.minor.size": 1.5,
    "xtick.minor.width": 0.4,
    "ytick.minor.width": 0.4,
    "axes.formatter.useoffset": False,
    "axes.formatter.limits": (-5, 6),
    "lines.linewidth": 0.9,
    "lines.solid_capstyle": "round",
    "lines.dash_capstyle": "butt",
    "legend.frameon": False,
    "legend.handlelength": 2.6,
    "legend.columnspacing": 1.6,
    "legend.handletextpad": 0.6,
    "legend.borderaxespad": 0.2,
    "legend.borderpad": 0.2,
    "figure.facecolor": "white",
    "figure.constrained_layout.h_pad": 0.05,
    "figure.constrained_layout.w_pad": 0.05,
    "path.simplify": True,
    "pdf.fonttype": 42,  # TrueType inside the file: text stays text, no Type 3 fonts
    "svg.fonttype": "path",  # outlines inside the file: a reader needs no font
    "svg.hashsalt": "hybridid",  # the same figure gives the same bytes
}


@dataclass(frozen=True)
class Plot:
    """A figure with the name of its files, its caption (one sentence) and the provenance of its data."""

    figure: Figure
    name: str
    caption: str
    provenance: str = "measured"


def context() -> AbstractContextManager[None]:
    """Matplotlib's defaults with this style; the previous settings are restored at the end."""
    defaults: dict[Any, Any] = dict(matplotlib.rcParamsDefault)
    defaults.pop("backend", None)  # setting it would load that backend
    return matplotlib.rc_context(defaults | _RC)


def is_wide(width: float) -> bool:
    """Whether a figure of ``width`` mm has room for panels side by side."""
    return width > (SINGLE_COLUMN + DOUBLE_COLUMN) / 2


Arguments = ParamSpec("Arguments")


def styled(draw: Callable[Arguments, Plot]) -> Callable[Arguments, Plot]:
    """Decorator: a figure function that runs in this style."""

    @functools.wraps(draw)
    def drawn(*args: Arguments.args, **kwargs: Arguments.kwargs) -> Plot:
        with context():
            return draw(*args, **kwargs)

    return drawn


def new_figure(width: float, height: float, title: str, provenance: str) -> Figure:
    """An empty figure of ``width`` by ``height`` mm whose first line says what it shows.

    The line ends in ``measured`` or ``simulated``; simulated data also get a framed mark in
    the corner.
    """
    engine = ConstrainedLayoutEngine(rect=(0, 0, 1, 1 - HEADER / height))
    figure = Figure(figsize=(width / MM_PER_INCH, height / MM_PER_INCH), layout=engine)
    FigureCanvasAgg(figure)
    left, right = MARGIN / width, 1 - MARGIN / width
    # a fixed distance below the top edge, also if a legend makes the figure higher
    line = figure.transFigure + ScaledTranslation(0, -0.55 * HEADER / MM_PER_INCH, figure.dpi_scale_trans)
    if provenance != "measured":
        frame = {"boxstyle": "round,pad=0.25", "facecolor": "white", "edgecolor": VERMILION, "linewidth": 0.8}
        mark = figure.text(
            right - 0.8 / width, 1, provenance.upper(), ha="right", va="center", transform=line,
            color=VERMILION, fontweight="bold", bbox=frame, gid="provenance",
        )  # fmt: skip
        right -= part_of_width(mark) + 4 * MARGIN / width
    heading = figure.text(left, 1, title, va="center", transform=line, color=SOFT_INK, gid="heading")
    shorten(heading, right - left, f" · {provenance}")
    return figure


def save(
    plot: Plot,
    folder: str | os.PathLike[str],
    name: str | None = None,
    kinds: Sequence[str] = KINDS,
) -> list[Path]:
    """Write ``plot`` into ``folder``, one file for each of ``kinds``, and return their paths.

    All are written under temporary names first, so that no partial file remains after a failure. Each has
    its caption and provenance as metadata, and no date: equal data give equal bytes.
    """
    folder, name = Path(folder), name or plot.name
    folder.mkdir(parents=True, exist_ok=True)
    about = f"{plot.caption} Data: {plot.provenance}."
    metadata = {
        "svg": {"Title": name, "Description": about, "Keywords": [plot.provenance], "Date": None},
        "pdf": {"Title": name, "Subject": about, "Keywords": plot.provenance, "CreationDate": None},
        "png": {"Title": name, "Description": about, "Keywords": plot.provenance},
    }
    with context(), tempfile.TemporaryDirectory(dir=folder, prefix=".figure-") as scratch:
        with _laid_out(plot.figure):
            for kind in kinds:
                plot.figure.savefig(Path(scratch) / f"figure.{kind}", dpi=PNG_DPI, metadata=metadata[kind])
        if "svg" in kinds:
            _shorten_numbers(Path(scratch) / "figure.svg")
        paths = [folder / f"{name}.{kind}" for kind in kinds]
        for path in paths:
            (Path(scratch) / f"figure{path.suffix}").replace(path)
    return paths


def _shorten_numbers(svg: Path) -> None:
    """Round coordinates to 1/100 point, much finer than print, which halves the file."""
    paths = re.compile(r' d="[^"]*"')
    text = svg.read_text(encoding="utf-8")
    svg.write_text(paths.sub(lambda d: re.sub(r"(\.\d\d)\d+", r"\1", d[0]), text), encoding="utf-8")


@contextmanager
def _laid_out(figure: Figure) -> Iterator[None]:
    """Compute the layout once and keep it; else matplotlib draws each file twice to compute it again."""
    engine = figure.get_layout_engine()
    if engine is not None and figure.axes:
        engine.execute(figure)
    figure.set_layout_engine(None)
    try:
        yield
    finally:
        figure.set_layout_engine(engine)
