"""Axes of all figures: scaled units, thinned lines and limits."""

from __future__ import annotations

import textwrap
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from numpy.typing import NDArray

from hybridid.plotting.looks import MASKED, Look
from hybridid.plotting.thinning import broken, thin
from hybridid.quantities import engineering, minus, with_unit

Array = NDArray[np.float64]
BLOCKS = 600  # blocks of a line, each drawn by its extremes; finer than a printed dot at 180 mm and 200 dpi
LINE = 24  # characters of a y label beside a panel of 25 mm


def axis_label(name: str, unit: str) -> str:
    """The label ``name [unit]`` of an axis; ``unit`` is already in its printed form."""
    return f"{name} [{unit}]"


@dataclass(frozen=True)
class Scale:
    """A quantity's name, the factor of its values, and the unit of the scaled values."""

    name: str
    factor: float
    unit: str

    @property
    def label(self) -> str:
        """The axis label: name and unit."""
        return axis_label(self.name, self.unit)

    def text(self, value: float) -> str:
        """``value`` (unscaled) with three digits in this scale's unit."""
        if not np.isfinite(value):
            return "not finite"
        scaled = value * self.factor
        number = f"{scaled:.0f}" if abs(scaled) >= 1000 else f"{scaled:#.3g}".rstrip(".")
        return with_unit(minus(number), self.unit)


def scale_for(name: str, unit: str, *values: Array) -> Scale:
    """The scale with the SI prefix that suits the largest finite magnitude of ``values``."""
    largest = max((np.abs(v[np.isfinite(v)]).max(initial=0.0) for v in values), default=0.0)
    return Scale(name.replace("_", " "), *engineering(float(largest), unit))


def time_scale(time: Array) -> Scale:
    """Seconds, or ms and µs for a short record."""
    return scale_for("time", "s", np.atleast_1d(time[-1] - time[0]))


def draw(
    axes: Axes,
    x: Array,
    y: Array,
    style: Look,
    label: str,
    starts: Array | None = None,
    steps: bool = False,
    blocks: int = BLOCKS,
) -> Line2D:
    """A line through the extremes of ``y`` in ``blocks``, interrupted before each of ``starts``."""
    x, y = thin(np.asarray(x, float), np.asarray(y, float), blocks)
    if starts is not None and len(starts):
        x, y = broken(x, y, starts)
    return axes.plot(
        x, y, label=label, color=style.colour, linestyle=style.dashes, linewidth=style.width,
        zorder=style.above, drawstyle="steps-post" if steps else "default",
    )[0]  # fmt: skip


def shade(axes: Axes, holes: Array, factor: float = 1.0) -> None:
    """Mark the masked stretches ``holes`` (h, 2) of the x axis, times ``factor``."""
    for start, stop in holes * factor:
        axes.axvspan(start, stop, color=MASKED, linewidth=0, zorder=0.5, gid="masked")


def frame(values: Iterable[Array], margin: float = 0.06) -> tuple[float, float]:
    """Limits around all finite values, with a margin; around zero if there is no span."""
    finite = [v[np.isfinite(v)] for v in map(np.asarray, values)]
    finite = [v for v in finite if len(v)]
    if not finite:
        return -1.0, 1.0
    low, high = min(float(v.min()) for v in finite), max(float(v.max()) for v in finite)
    span = (high - low) or abs(high) or 1.0
    return low - margin * span, high + margin * span


def frame_data(data: Array, models: Sequence[Array], reach: float = 0.6) -> tuple[float, float]:
    """Limits around ``data`` that include the models up to ``reach`` data spans beyond it.

    A model that diverges must not compress the measurement into a flat line.
    """
    low, high = frame([data], 0.0)
    room = reach * ((high - low) or abs(high) or 1.0)
    lowest, highest = frame([data, *models])
    return max(lowest, low - room), min(highest, high + room)


def leaves(values: Array, limits: tuple[float, float]) -> bool:
    """Whether any of ``values`` lies outside ``limits`` or is not finite."""
    return bool(np.any(~np.isfinite(values) | (values < limits[0]) | (values > limits[1])))


def name_y(axes: Axes, scale: Scale) -> None:
    """Label the y axis, in as many lines as its panel's height needs."""
    axes.set_ylabel("\n".join(textwrap.wrap(scale.label, LINE)))
