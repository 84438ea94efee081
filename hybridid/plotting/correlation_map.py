"""The correlation matrix of a set of estimates, as a map that also reads without colour."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

from matplotlib.axes import Axes
from matplotlib.image import AxesImage

from hybridid.plotting.axes import Array
from hybridid.plotting.lettering import root, shorten
from hybridid.plotting.looks import INK
from hybridid.quantities import fixed

WRITTEN = 6  # parameters up to which the numbers fit into the cells


def correlation_map(axes: Axes, names: Sequence[str], correlation: Array, title: str, room: float) -> None:
    """Draw ``correlation`` (n, n), from blue (−1) over white to red (+1), with its numbers in the cells, or a
    scale of colours beside it where these are too many.

    ``title`` is cut to ``room``, a part of the figure's width.
    """
    image = axes.imshow(correlation, cmap="RdBu_r", vmin=-1, vmax=1, interpolation="nearest")
    places, short = range(len(names)), short_names(names)
    axes.set_xticks(places, short, rotation=90 if max(map(len, short)) > 4 else 0)
    axes.set_yticks(places, short)
    axes.tick_params(length=0)
    axes.grid(False)
    axes.spines[:].set_visible(False)
    if len(names) <= WRITTEN:
        for row in places:
            for column in places:
                value = float(correlation[row, column])
                colour = "white" if abs(value) > 0.6 else INK
                axes.text(column, row, fixed(value, 2), ha="center", va="center", fontsize=5.5, color=colour)
    shorten(axes.set_title(f"correlation: {title}"), room)
    if len(names) > WRITTEN:
        _colours(axes, image)


def _colours(axes: Axes, image: AxesImage) -> None:
    """A scale of colours at the right of the map."""
    beside = axes.inset_axes((1.05, 0.0, 0.045, 1.0))
    bar = root(axes).colorbar(image, cax=beside, label="correlation [–]", ticks=(-1, 0, 1))
    bar.outline.set_visible(False)


def short_names(names: Sequence[str]) -> list[str]:
    """The last part of ``carriage.viscous.f_v`` where it names one parameter alone."""
    last = [name.rsplit(".", 1)[-1] for name in names]
    count = Counter(last)
    return [short if count[short] == 1 else name for name, short in zip(names, last, strict=True)]
